#!/bin/sh
# Checks the programs of this folder; a warning counts as an error. Add new programs to the last line.
set -eu
cd "$(dirname "$0")"
exec yarc check --strict @NAME@.yarc
