#!/usr/bin/env bash
# Builds web/ into server/console, where the server and the wheel look for it.
set -euo pipefail
cd web
[ -d node_modules ] && [ node_modules -nt package-lock.json ] || npm ci --no-audit --no-fund --loglevel=error
touch node_modules
npm run --silent build
