#!/usr/bin/env bash
# Type-checks the console.
set -euo pipefail
cd web
npm run --silent check
