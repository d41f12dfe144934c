# `make demo` drives one episode, `make test` runs the tests; both build .venv first.
PY ?= python3
VENV := .venv
BIN := $(VENV)/bin

.PHONY: demo bench test clean

demo: $(VENV)/.installed
	$(BIN)/fuzzynav run concave --seed 0 --rrd concave.rrd

bench: $(VENV)/.installed
	$(BIN)/fuzzynav bench --out results --resume

test: $(VENV)/.installed
	$(BIN)/pytest

$(VENV)/.installed: pyproject.toml
	$(PY) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check -e ".[test]"
	touch $@

clean:
	rm -rf $(VENV)
