# Each target sets up a virtual environment first. The README names `make test`, `make test-slow` and `make figures`.
PYTHON ?= python3
BIN := .venv/bin
# a hundred tests start processes, which would each compile the package anew
unexport PYTHONDONTWRITEBYTECODE

ANDREWS := --scene andrews --time 0.01 --h 16e-6 --h 32e-6 --h 64e-6 --h 128e-6 \
    --method ABM4 --method AB4 --method RK4 --method dopri5 --method B4 --method trapezoid --table none

# feedback and projection, of which no time is drawn
HELD := tradeoff --against projection --method B4 --method AB4 --method RK4 --method SYM --repeats 1 --table none
OF_MILLISECONDS := --h 0.0008 --h 0.0016 --h 0.0032 --h 0.005 --h 0.008 --h 0.0125

.PHONY: region figures times test quick test-slow test-oldest witnesses campaign extremes lint bench clean

region: .venv/installed  ## draw where symplectic Euler is stable, into this directory
	$(BIN)/bezstab region --method SYM

figures: .venv/installed  ## draw what the pages show, into figures/
	$(BIN)/bezstab region --method SYM --table none -o figures
	$(BIN)/bezstab region --method B4 --scene driven_four_bar --h 0.005 --speed 1 --speed 3 --speed 6 --table none -o figures
	$(BIN)/bezstab drive --kp 200 --kd 5 --inertia 0.1 --h 0.002 --every 4 --late 1 --method SYM --figure png -o figures
	$(BIN)/bezstab verify --map 60 --method AB4 --table none -o figures
	$(BIN)/bezstab paper -o figures
	$(BIN)/bezstab chain --engine chipmunk --h 1/60 --bodies 20 --mass-ratio 10 --figure png -o figures \
	    > /dev/null || test $$? = 1
	$(BIN)/bezstab region --method RK4 --accuracy --table none -o figures
	$(BIN)/bezstab region --method SYM --motion --table none -o figures
	$(BIN)/bezstab tradeoff --table none -o figures
	$(BIN)/bezstab $(HELD) $(OF_MILLISECONDS) -o figures
	$(BIN)/bezstab $(HELD) --scene driven_four_bar $(OF_MILLISECONDS) -o figures
	$(BIN)/bezstab $(HELD) --scene andrews --time 0.01 --h 8e-6 --h 16e-6 --h 32e-6 --h 64e-6 --h 128e-6 -o figures

times: .venv/installed  ## measure anew the processor times that figures and tables show: no two runs share them
	$(BIN)/bezstab tradeoff $(ANDREWS) --against time --repeats 9 --workers 1 -o figures
	$(BIN)/python -m tests.paper.record_times

# two processes on two cores: threads of linear algebra in each would wait for each other most of the time
quick test-slow test-oldest campaign: export OPENBLAS_NUM_THREADS := 1

test: .venv/tested  ## what CI runs: style and types, and at the same time the quick tests
	$(MAKE) --no-print-directory --jobs 2 lint quick

quick: .venv/tested
	$(BIN)/python -m pytest -m "not slow" -n 2 --dist loadfile

test-slow: .venv/tested  ## the checks that take minutes
	$(BIN)/python -m pytest -m slow -n 2 --dist worksteal

test-oldest:  ## the same tests with the oldest versions that pyproject.toml allows
	$(PYTHON) -m venv .venv-oldest
	.venv-oldest/bin/python -c 'import tomllib; p = tomllib.load(open("pyproject.toml", "rb"))["project"]; \
	    print("\n".join(p["dependencies"]).replace(">=", "=="))' > .venv-oldest/oldest.txt
	.venv-oldest/bin/pip install --quiet --editable '.[test]' --constraint .venv-oldest/oldest.txt
	.venv-oldest/bin/python -m pytest -m "not slow" -n 2 --dist loadfile

witnesses: .venv/tested  ## engines that are not ours, run: PyBullet, pymunk, Box2D, Exudyn, MuJoCo, three in JavaScript
	$(BIN)/pip install --quiet --editable '.[witnesses]'
	-npm install --silent --no-save --ignore-scripts --prefix .venv/javascript matter-js@0.20 cannon-es@0.20 p2@0.7
	$(BIN)/python -m pytest tests/witnesses tests/runs/test_mujoco_maps.py tests/runs/test_mujoco_energy.py

extremes: .venv/tested  ## what holds at the extremes, in minutes, into figures/extremes.md
	$(BIN)/python -m tests.extremes.checks

lint: .venv/tested  ## style, format and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench: .venv/benched  ## speed, as ratios measured in one run, into figures/bench.md
	$(BIN)/python -m tests.bench.bench

campaign: .venv/tested  ## regions of 10,000 random methods against verdicts in rationals and a plain rule, in hours
	METHODS=5000 $(BIN)/python -m pytest -m slow tests/stability/test_campaign.py

clean:  ## remove the virtual environments
	rm -rf .venv .venv-oldest

# pip leaves compiling to Python, which compiles what is imported only: that halves the time it takes
.venv/installed: pyproject.toml
	$(PYTHON) -m venv .venv
	$(BIN)/pip install --quiet --no-compile --editable .
	touch $@

.venv/benched: .venv/installed
	$(BIN)/pip install --quiet --no-compile --editable '.[bench]'
	touch $@

.venv/tested: pyproject.toml  # in one go: first the package alone, then the rest, would take longer
	$(PYTHON) -m venv .venv
	$(BIN)/pip install --quiet --no-compile --editable '.[test,lint]'
	touch .venv/installed $@
