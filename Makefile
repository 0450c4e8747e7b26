# Everything that one does daily. Needs Debian's python3 (3.11), python3-venv, make and git; no compiler.
.DEFAULT_GOAL := help
.PHONY: help setup demo test test-pure test-long test-flaky test-faults mutants lint format docs diagrams pictures schema shapes models relations-picture drive-picture foreign-picture perceive-picture train-perception wheel clean

UV_VERSION := 0.13.8
UV := .tools/bin/uv
BIN := .venv/bin
export UV_PYTHON_DOWNLOADS := never

help:  ## Show this list
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):[^#]*## /  make \1\t/' | expand -t 20

setup: .venv/.ready  ## Install everything into .venv, as locked; and what rendering needs, where allowed
	@sh demo/system_packages.sh

$(UV):
	python3 -m venv .tools
	.tools/bin/pip install --quiet --disable-pip-version-check uv==$(UV_VERSION)

.venv/.ready: uv.lock pyproject.toml | $(UV)
	@echo "installing the locked environment; compiling its modules at the end takes a minute or two, without output"
	$(UV) sync --locked --compile-bytecode --python python3
	@$(BIN)/python -m compileall -q semmap semmap/nodes semmap/schemas semmap/ontology  # each start of a node, too, is quicker
	@touch $@

demo: setup  ## A tour through the commands and a drive; leaves demo/flat.owl, session.rrd, drive.rrd, scene.png
	$(BIN)/python -m demo.tour

test-pure: setup  ## The tests that need no processes; PART=tests/coordinator runs those of a folder in seconds
	$(BIN)/pytest -q $(if $(PART),$(PART),-n 2 --dist worksteal) -m "not process and not long"

test: setup  ## Style, types, import rules and all tests but the long ones
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python -m tests.suite

test-long: setup  ## The tests that take longer too, and all tries of those that search
	SEMMAP_THOROUGH=1 $(BIN)/pytest -n 2 -o faulthandler_timeout=7200 -o faulthandler_exit_on_timeout=true

test-flaky: setup  ## The tests that need processes, N=10 times in random order, beside LOAD=2 busy loops
	$(BIN)/python -m tests.suite.repeats --times $(or $(N),10) --load $(or $(LOAD),0)

test-faults: setup  ## Kill, stop, forge, send nonsense: nothing acknowledged may be lost or done twice; half an hour
	$(BIN)/python -m tests.faults.mutations 20000
	$(BIN)/python -m tests.faults

mutants: setup  ## Change lines of a node at random, and list what its tests miss; PART=nodes/coordinator N=60 SEED=1
	$(BIN)/python -m tests.mutants $(PART) --number $(or $(N),60) --seed $(or $(SEED),1) --jobs $(or $(JOBS),2)

lint: setup  ## Style, types and the rules of who imports whom
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: setup  ## Format the code
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

docs: setup  ## Build the manual into dist/docs; strict, works offline
	$(BIN)/python docs/_ext/command_line.py
	$(BIN)/sphinx-build -W --keep-going -q -b html docs dist/docs
	@echo dist/docs/index.html

diagrams: setup  ## Draw the manual's Mermaid diagrams that have changed; needs node and Debian's chromium
	$(BIN)/python docs/_ext/diagrams.py

schema: setup  ## Write the JSON Schema of scene files anew
	$(BIN)/python -m semmap.schemas.scene_files > schemas/scene.schema.json

shapes: setup  ## Write the models' sizes, support surfaces and hollows anew, for the other nodes
	$(BIN)/python -m semmap.nodes.sim_node.models.write_shapes
	$(BIN)/python -m semmap.nodes.training.model_surfaces

models: setup  ## Draw the contact sheet of all models
	$(BIN)/python -m semmap.nodes.sim_node.models.contact_sheet docs/models.png

pictures: setup  ## Render the screenshots, the plan and the movie of the manual; needs Debian's chromium
	$(BIN)/python docs/_ext/pictures.py

drive-picture: setup  ## Draw what cameras saw in the drive that `make demo` has recorded
	$(BIN)/python -m demo.strip docs/drive.png

relations-picture: setup  ## Draw the situations of docs/relations.md
	$(BIN)/python -m benchmarks.relations.picture docs/relations.png

perceive-picture: setup  ## Draw the classes that perception reports of a simulated table
	$(BIN)/python -m benchmarks.perception.perceive_picture docs/perceive.png

foreign-picture: setup  ## Draw what foreign things are taken for by what learnt from all others in dist/parts
	$(BIN)/python -m benchmarks.perception.foreign_picture docs/foreign.png --things $${SEMMAP_DATA:-../shared/data}/foreign --samples dist/parts

train-perception: setup  ## Learn anew what perception knows, from recorded scenes and foreign things too: an hour or two
	$(BIN)/python -m semmap.nodes.training.segmentation --recorded $${SEMMAP_DATA:-../shared/data}/mosd
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python -m semmap.nodes.training.recognition --foreign $${SEMMAP_DATA:-../shared/data}/foreign --parts dist/parts
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python -m semmap.nodes.training.recognition.learn_similarity --parts dist/parts
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python -m semmap.nodes.training.recognition.learn_images $${SEMMAP_DATA:-../shared/data}/foreign

train-language: setup  ## Learn anew what commands mean, from the HuRIC corpus: a minute
	$(BIN)/python -m semmap.nodes.training.language $${SEMMAP_DATA:-../shared/data}/huric

wheel: setup  ## Build the wheel into dist/
	$(BIN)/python -m hatchling build -t wheel

clean:  ## Remove what was installed and built
	rm -rf .venv .tools dist .pytest_cache .hypothesis .mypy_cache .ruff_cache demo/data
