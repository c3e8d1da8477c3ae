"""Figures and tables of regions, lists of methods and families."""

import csv
from pathlib import Path

import numpy as np
import pytest

from bezstab.methods.registry import lookup
from bezstab.stability.regions import region
from tests.cli.running import arrays, rows, run


def test_the_tables_of_a_map_and_of_compared_boundaries(tmp_path: Path) -> None:
    window = "--grid 11 --alpha-range -0.1 0.5 --beta-range 1/10 2/10 --h 0.001"
    run("region --method B3 -o out --figure none --table npz", window)
    table = arrays(tmp_path / "out" / "region_B3.npz")
    assert table["beta_hat"][::11] == pytest.approx(np.linspace(0.1, 0.2, 11))
    assert table["two_alpha"][:11] == pytest.approx(np.linspace(-0.1, 0.5, 11) * 1e3)
    run("region --quality fast --accuracy --figure none --table npz")
    points = arrays(tmp_path / "region_B4_accuracy.npz")
    assert list(points) == ["alpha_hat", "beta_hat", "z_abs", "z_angle_deg", "combined_error"]
    assert (np.isnan(points["combined_error"]) == (points["z_abs"] >= 1)).all()
    assert rows("region --compare --method B4 --figure none --table csv --level 0.9")[0]["z_abs_below"] == 0.9
    with (tmp_path / "compare_B4.csv").open(encoding="utf-8") as file:
        drawn = [[float(row["alpha_hat"]), float(row["beta_hat"])] for row in csv.DictReader(file)]
    assert drawn == np.concatenate(region(lookup("B4"), 0.9).boundary).tolist()


def test_a_method_whose_region_only_comes_near_its_largest_beta_hat_far_out_says_so(tmp_path: Path) -> None:
    """Stable where 2 beta_hat < alpha_hat (4 - beta_hat) < 8, from its characteristic polynomial."""
    update = {
        "x1": "x0 + v0 + 1/2 first",
        "v1": "v0 + second",
        "first": "acceleration(x0, 1/2 v0 + 1/2 v1)",
        "second": "acceleration(x0, v0)",
    }
    (tmp_path / "own.toml").write_text(
        "\n".join(["[update]", *(f'{name} = "{text}"' for name, text in update.items())])
    )
    assert "\napproached far out  the largest β̂\n" in run("region --method own.toml --figure none").stdout
    assert "approached" not in run("region --method verlet-implicit --figure none").stdout
