"""The paper this tool grew from: what it prints, its runs, its claims, its figures."""
