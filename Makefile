# Everything starts here: each target makes what it needs, from Python 3.11, pip and make alone.

VENV := .venv
BIN := $(VENV)/bin
# exists only while .venv is complete: a set-up that was cut off is begun again from nothing
READY := $(VENV)/.ready
PYTHONS := $(or $(PYTHON),python3.11 python3.12 python3.13 python3 python)
USABLE := import sys, venv, ensurepip; sys.exit(not (3, 11) <= sys.version_info < (3, 14))
# in CI, Python compiles what it imports; pip would compile all that the libraries hold
PIP_FLAGS := --disable-pip-version-check $(if $(CI),--quiet --no-compile)
# else each process of the tests compiles all that it imports
unexport PYTHONDONTWRITEBYTECODE
TESTS ?= tests
# one more than there are cores: tests that wait for a process or a server leave theirs idle
JOBS ?= $(shell expr 1 + $$(getconf _NPROCESSORS_ONLN || echo 1))

.DEFAULT_GOAL := help
.PHONY: help install test rigs lint audit format docs check-docs schemas configuration readme-picture reproduce-thesis benchmark study-coverage study-evidence study-recovery study-laws study-declarations study-blunders study-rebuilt study-servo study-strangers study-sweep study-slurm study-fleet league league-drawn league-measured torture clean distclean FORCE

help: ## say what can be made
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-18s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)
	@echo
	@echo "  PYTHON=...       the Python to make .venv with (default: the first of 3.11 to 3.13 on the PATH)"
	@echo "  TESTS=...        the tests to run (default: tests); JOBS=... in how many processes (default: one more than cores)"
	@echo "  ARGS=...         for make league, league-drawn, league-measured, study-laws, study-declarations, study-rebuilt, study-strangers, study-fleet and torture, e.g. ARGS='--only noisy --limit 10'; ARGS=--help says more"

install: $(READY) ## set up .venv (the other targets do it by themselves)

test: $(READY) ## run the tests
	$(BIN)/python -m pytest -n $(JOBS) --dist worksteal --durations=15 --durations-min=1 $(TESTS)

rigs: $(READY) ## compile the simulation of the virtual rigs ahead (half a minute, once)
	@folder=$$(mktemp -d); $(abspath $(BIN))/hybridid fit case=emps data=simulated rig.duration=0.2 mlflow.enabled=false \
		paths.outputs=$$folder > $$folder/said 2>&1 || { cat $$folder/said; exit 1; }; rm -r $$folder

lint: $(READY) ## check style and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

audit: $(READY) ## look for known faults in our code (bandit) and in the libraries (pip-audit)
	.ci/audit $(BIN)/python

format: $(READY) ## put every file in the house style
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

docs: $(READY) ## build all pages, the API's too; a warning is an error: outputs/docs/docs/index.html
	$(BIN)/sphinx-build -W --keep-going --quiet --jobs $(JOBS) -c docs . outputs/docs

check-docs: $(READY) ## is every link and reference of the pages right, the API's too? It writes none
	$(BIN)/sphinx-build -b dummy -W --keep-going --quiet -c docs . outputs/checked-docs

schemas: $(READY) ## docs/results.md and docs/schemas from the types of the result files
	$(BIN)/python docs/write_schemas.py

configuration: $(READY) ## docs/configuration.md from the dataclasses that declare the keys of a config
	$(BIN)/python docs/write_configuration.py

readme-picture: $(READY) ## draw the README's picture from a trace of the measured EMPS records (a minute or two)
	$(BIN)/hybridid trace case=emps estimator.horizon=1000
	$(BIN)/python docs/readme_picture.py outputs/emps/latest/trace/trace.json

reproduce-thesis: $(READY) ## the thesis' tables and figures beside ours: outputs/thesis/index.html
	$(BIN)/hybridid reproduce

study-coverage: $(READY) ## do the stated 95 % intervals hold the truth? (simulated, minutes)
	$(BIN)/python benchmarks/interval_coverage.py

study-evidence: $(READY) ## how often does the evidence for a missing effect err, or miss one? (simulated, hours)
	OMP_NUM_THREADS=1 $(BIN)/python benchmarks/evidence_power.py

study-recovery: $(READY) ## do the gray boxes find the rigs' known parameters again? (simulated, minutes)
	$(BIN)/python benchmarks/recovery.py

study-laws: $(READY) ## is the law proposed where the library lacks the effect, and none where nothing is missing? (simulated, hours; goes on)
	OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 $(BIN)/python -m benchmarks.laws $(ARGS)

study-declarations: $(READY) ## is declared physics that is wrong told, and sound physics left in peace? (simulated, hours; goes on)
	OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 $(BIN)/python -m benchmarks.declarations $(ARGS)

study-blunders: $(READY) ## is a planted blunder (sign, unit, columns, physics, plant) told in words? (simulated, minutes)
	OMP_NUM_THREADS=1 $(BIN)/python -m benchmarks.blunders $(ARGS)

study-rebuilt: $(READY) ## is trace right or honest where it was wrong on records by others? (simulated, hours; goes on)
	OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 $(BIN)/python -m benchmarks.rebuilt $(ARGS)

benchmark: $(READY) ## how fast are fits, simulations, commands and traces, beside other ways to the same? (half an hour)
	OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 $(BIN)/python -m benchmarks.speed $(ARGS)

study-servo: $(READY) ## how well does the servo's model predict a trajectory of another kind? (measured, minutes)
	$(BIN)/python benchmarks/servo.py

study-strangers: $(READY) ## all that a stranger must be able to do, on one page: templates, servo, rigs, kills (simulated, the servo measured; 20 minutes)
	OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 $(BIN)/python -m benchmarks.strangers $(ARGS)

study-sweep: $(READY) ## how much faster than a plain loop is a sweep? (simulated, minutes)
	$(BIN)/python benchmarks/sweep_speed.py

study-slurm: $(READY) ## 64 jobs on a Slurm of one node, one killed on purpose (simulated; needs slurm-wlm, munge)
	$(BIN)/python -m benchmarks.slurm.study

study-fleet: $(READY) ## 40 machines traced on a Slurm of one node, one worker killed on purpose (simulated; needs slurm-wlm, munge)
	$(BIN)/python -m benchmarks.slurm.fleet $(ARGS)

league: $(READY) ## which of ours and two rivals names what simulated machines hide? (hours; continues where it stopped)
	OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 $(BIN)/python -m benchmarks.league $(ARGS)

league-drawn: $(READY) ## does our trace hold on 120 randomly drawn scenarios? (hours; continues where it stopped)
	OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 $(BIN)/python -m benchmarks.drawn $(ARGS)

league-measured: $(READY) ## what does trace say of every measured record, also with each declared effect left out? (goes on)
	OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 $(BIN)/python -m benchmarks.measured $(ARGS)

torture: $(READY) ## bad inputs, kills, full disks, many writers, long records: is anything lost? (simulated, hours; goes on)
	OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 $(BIN)/python -m benchmarks.torture $(ARGS)

clean: ## remove what tools and builds left behind (never outputs/ or data/)
	rm -rf build dist .pytest_cache .mypy_cache .ruff_cache
	find . -path ./$(VENV) -prune -o -name __pycache__ -type d -prune -exec rm -rf {} +

distclean: clean ## clean, and remove .venv
	rm -rf $(VENV) .venv-audit

# FORCE: a .venv whose Python is gone (upgraded or moved away) is made anew
$(READY): pyproject.toml constraints.txt $(shell $(BIN)/python -c 1 2>/dev/null || echo FORCE)
	@if [ -e $@ ] && $(BIN)/python -c 1 2>/dev/null; then \
		echo "bringing $(VENV) up to date"; \
	else \
		python=$$(for p in $(PYTHONS); do "$$p" -c '$(USABLE)' >/dev/null 2>&1 && echo "$$p" && break; done); \
		if [ -z "$$python" ]; then \
			echo "no usable Python among: $(PYTHONS). Install Python 3.11, 3.12 or 3.13 with venv and pip," \
				"or name one: make $(MAKECMDGOALS) PYTHON=/path/to/python3.11" >&2; \
			exit 1; \
		fi; \
		echo "setting up $(VENV) with $$python (once, some minutes)"; \
		rm -f $@ && "$$python" -m venv --clear $(VENV); \
	fi
	@rm -f $@
	$(BIN)/python -m pip install $(PIP_FLAGS) --constraint constraints.txt --editable '.[dev]'
	@touch $@
