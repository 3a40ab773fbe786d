# make setup | run | test | check | bench | figures   (see README.md)
PYTHON  ?= $(shell command -v python3.11 || command -v python3)
VENV    := .venv
PY      := $(VENV)/bin/python
HOST    ?= 127.0.0.1
PORT    ?= 8000
SOURCE  ?= recordings/greenhouse_demo.mcap
CONSOLE := server/console/index.html

.PHONY: setup run test check bench figures lock clean
setup: $(VENV)/.installed $(CONSOLE)

$(VENV)/.installed: pyproject.toml constraints.txt tools/make_venv.sh
	@PYTHON="$(PYTHON)" tools/make_venv.sh $(VENV)
	@touch $@

WEB_SOURCES := $(shell find web -type f -not -path 'web/node_modules/*' -not -path 'web/dist/*' 2>/dev/null)
$(CONSOLE): $(WEB_SOURCES) $(VENV)/.installed
	@tools/with_node.sh $(VENV) tools/build_console.sh
	@touch $@

run: setup
	@$(VENV)/bin/teleop serve --host "$(HOST)" --port "$(PORT)" --source "$(SOURCE)" --loop

check: setup
	@$(VENV)/bin/ruff check .
	@$(VENV)/bin/ruff format --check .
	@$(VENV)/bin/mypy
	@$(VENV)/bin/lint-imports
	@tools/with_node.sh $(VENV) tools/check_console.sh

test: check
	@$(PY) -m pytest

bench: setup
	@$(PY) -m benchmarks

figures: setup
	@$(PY) -m benchmarks.figures

# Rewrites constraints.txt from what is installed now (run after changing a dependency).
lock:
	@$(PY) -m pip freeze --exclude-editable --exclude greenhouse-teleop --exclude pip --exclude setuptools > constraints.txt

clean:
	rm -rf $(VENV) web/node_modules web/dist server/console build dist *.egg-info
