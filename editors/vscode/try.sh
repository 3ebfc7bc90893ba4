#!/usr/bin/env bash
# Try the extension in VS Code itself, without a screen: VS Code as a server, which any browser shows. As `npm run try`, or
#
#     bash try.sh [FOLDER [PORT]]
#
# It is installed into FOLDER (~/.cache/yarc-vscode; half a gigabyte, some minutes, a C++ compiler, Node.js 20) and shows
# copies of the examples at 127.0.0.1:PORT (8931), to whoever may reach that port on this machine, until Ctrl-C.
set -euo pipefail

version=4.100.3 # VS Code 1.100.3
here=$(cd "$(dirname "$0")" && pwd)
folder=${1:-${XDG_CACHE_HOME:-$HOME/.cache}/yarc-vscode}
port=${2:-8931}
server=$folder/node_modules/code-server
code=$server/lib/vscode

mkdir -p "$folder/work"
cd "$folder"
if [ ! -e "$folder/installed" ]; then
  [ -e package.json ] || echo '{ "private": true }' > package.json
  # its own script fetches and builds more than is needed here
  npm install --ignore-scripts --no-audit --no-fund "code-server@$version"
  npm rebuild --foreground-scripts argon2
  (
    cd "$code"
    npm install --omit=dev --ignore-scripts --no-audit --no-fund
    npm rebuild --foreground-scripts @vscode/spdlog native-watchdog
    npm rebuild --foreground-scripts node-pty || echo "VS Code will have no terminal"
    mkdir -p node_modules/@vscode/ripgrep/bin
    if rg=$(command -v rg); then ln -sfn "$rg" node_modules/@vscode/ripgrep/bin/rg; else echo "without ripgrep, VS Code finds no files by name"; fi
    ln -sfn node_modules node_modules.asar
    ln -sfn code-linux.sh bin/remote-cli/code-server
    ln -sfn browser-linux.sh bin/helpers/browser.sh
  )
  touch "$folder/installed"
fi

[ -d "$here/node_modules" ] || (cd "$here" && npm ci)
(cd "$here" && npm run package)
cp "$here"/../../examples/* work/

yarc=$(command -v yarc) || yarc= # then the extension says what to do
mkdir -p data/User
printf '{ "yarc.path": "%s", "workbench.startupEditor": "none", "files.autoSave": "off" }\n' "$yarc" > data/User/settings.json
options=(--config "$folder/config.yaml" --user-data-dir "$folder/data" --extensions-dir "$folder/extensions")
node "$server/out/node/entry.js" "${options[@]}" --force --install-extension "$here/yarc.vsix"
exec node "$server/out/node/entry.js" "${options[@]}" --auth none --bind-addr "127.0.0.1:$port" \
  --disable-telemetry --disable-update-check --disable-workspace-trust "$folder/work"
