# make demo, make test: everything else is for those who work on garmentcad.
VENV ?= .venv
PYTHON ?= python3
BIN := $(VENV)/bin
DEMO_GARMENT ?= flared-skirt
DEMO_OPTIONS ?= --grid 15
DEMO_FOLDER ?= out/demo
BLENDER_PYTHON ?= python3.13
BENCH_OPTIONS ?=

.PHONY: demo test lint study bench clean

demo: $(VENV)/.installed
	@$(BIN)/garmentcad drape $(DEMO_GARMENT) -o $(DEMO_FOLDER) $(DEMO_OPTIONS)
	@echo "installation took $$(cat $(VENV)/.installed) s when the environment was made"

# Tests start dozens of processes, of which each would compile the program's modules anew where Python is told to keep none of them.
test: export PYTHONDONTWRITEBYTECODE =
test: $(VENV)/.installed
	$(BIN)/ruff check garmentcad tests tools bench
	@# types are checked beside the tests: both are looked at, whatever the other says
	$(BIN)/mypy garmentcad & types=$$!; \
	$(BIN)/python -m pytest -n 2 --dist loadfile --no-loadscope-reorder; tests=$$?; \
	wait $$types && exit $$tests

lint: $(VENV)/.installed
	$(BIN)/ruff check garmentcad tests tools bench
	$(BIN)/mypy garmentcad

study: $(VENV)/.installed
	$(BIN)/python -m tools.body_study
	$(BIN)/python -m tools.study
	$(BIN)/python -m tools.rule_study
	$(BIN)/python -m tools.garmentcode_study
	$(BIN)/python -m tools.contact_queries
	$(BIN)/python -m tools.stress_study
	$(BIN)/python -m tools.agreement_study
	$(BIN)/python -m tools.friction_cost_study
	$(BIN)/python -m tools.detection_study
	$(BIN)/python -m tools.scaling_study
	$(BIN)/python -m tools.cold_start_study
	$(BIN)/python -m tools.garment_test_study
	$(BIN)/python -m tools.wardrobe_study
	$(BIN)/python -m tools.size_study
	$(BIN)/python -m tools.soak_study
	$(BIN)/python -m tools.movement_study
	$(BIN)/python -m tools.outfit_study
	$(BIN)/python -m tools.jitter_study
	$(BIN)/python -m tools.kill_study
	$(BIN)/python -m tools.determinism_study
	$(BIN)/python -m tools.machines_study --minutes 30
	$(BIN)/python -m tools.passport_study
	$(BIN)/python -m tools.drape_study
	$(BIN)/python -m tools.fuzz_study

bench: $(VENV)/.installed
	$(BIN)/python -m bench.compare --blender-python $(BLENDER_PYTHON) $(BENCH_OPTIONS)

$(VENV)/.installed: pyproject.toml
	@start=$$(date +%s); \
	$(PYTHON) -c 'import sys; sys.exit("garmentcad needs Python 3.11 or later, this is " + sys.version.split()[0] if sys.version_info < (3, 11) else 0)' && \
	$(PYTHON) -m venv $(VENV) && \
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[view,test,dev]' && \
	echo $$(( $$(date +%s) - start )) > $@

clean:
	rm -rf $(VENV) out build *.egg-info
