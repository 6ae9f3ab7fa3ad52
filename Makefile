# Every target makes .venv itself; nothing else needs to be set up.
PYTHON ?= python3
# Tests run in a process a core; linear algebra then needs no threads of its own.
TEST = OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -n auto
BIN = .venv/bin
READY = .venv/.ready

OLDEST = .venv-oldest/bin

.PHONY: demo test test-all test-oldest check bench docs fuzz clean

demo: $(READY)
	$(BIN)/subsoil demo --out demo --overwrite
	@echo "Open demo/report.html; demo/survey.gpkg opens in QGIS."

test: $(READY)
	$(TEST) -m "not gis"

test-all: $(READY)
	tools/install_system.sh
	$(TEST)

# Fast tests with the oldest releases that pyproject.toml allows, of what it names itself.
test-oldest: .venv-oldest/.ready
	OPENBLAS_NUM_THREADS=1 $(OLDEST)/python -m pytest -n auto -m "not slow and not gis"

.venv-oldest/.ready: pyproject.toml
	$(PYTHON) -m venv --clear .venv-oldest
	$(OLDEST)/python -m pip install --quiet uv
	$(OLDEST)/uv pip install --quiet --python $(OLDEST)/python --resolution lowest-direct --editable '.[dev]'
	@touch $@

check: $(READY)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(TEST) -m "not slow and not gis"

# Twenty thousand broken files; `make test` reads two thousand.
fuzz: $(READY)
	SUBSOIL_FUZZ=20000 $(TEST) tests/fuzz

bench: $(READY)
	$(BIN)/python -m benchmarks

# Warnings are errors: a name that is not there, a page that nothing leads to, an example that fails.
docs: $(READY)
	rm -rf docs/examples docs/reference/api docs/reference/commands docs/reference/rooms
	$(BIN)/python -m sphinx --builder html --fresh-env --fail-on-warning --keep-going --quiet docs docs/_build/html
	@echo "Open docs/_build/html/index.html."

$(READY): pyproject.toml
	@$(PYTHON) -c 'import sys; assert sys.version_info >= (3, 11)' || \
		{ echo "subsoil needs Python 3.11 or newer; set PYTHON=/path/to/python3.11"; exit 2; }
	@$(PYTHON) -c 'import ensurepip, venv' || \
		{ echo "Python lacks venv; on Debian: apt install python3-venv"; exit 2; }
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet --editable '.[dev]'
	@touch $(READY)

clean:
	rm -rf .venv .venv-oldest demo bench-results docs/_build docs/examples docs/reference/api \
		docs/reference/commands docs/reference/rooms build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
