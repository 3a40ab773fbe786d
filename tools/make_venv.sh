#!/usr/bin/env bash
# Makes the virtual environment at $1 and installs the locked packages into it.
set -euo pipefail
venv=$1
if [ -x "$venv/bin/python" ] && ! "$venv/bin/python" -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))'; then
    rm -rf "$venv"
fi
if [ ! -x "$venv/bin/python" ]; then
    if [ -n "${PYTHON:-}" ] && "$PYTHON" -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' 2>/dev/null \
        && "$PYTHON" -c 'import ensurepip' 2>/dev/null; then
        "$PYTHON" -m venv "$venv"
    elif command -v uv >/dev/null; then
        uv venv --seed --python 3.11 "$venv"
    else
        found=$("${PYTHON:-python3}" --version 2>/dev/null || echo "no Python")
        echo "setup: Python 3.11 with venv is needed (pybullet has no wheels for newer ones); found: $found." >&2
        echo "       Debian/Ubuntu: apt install python3.11 python3.11-venv; or install uv, which brings its own;" >&2
        echo "       or name an interpreter: make PYTHON=/path/to/python3.11 setup" >&2
        exit 1
    fi
fi
echo "setup: installing Python packages into $venv (a few minutes the first time)"
"$venv/bin/python" -m pip install --quiet --disable-pip-version-check \
    --constraint constraints.txt --editable '.[dev,train,sensors,cluster,datasets]'
