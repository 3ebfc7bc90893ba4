-- YARC for Neovim 0.11 and newer, where `vim.lsp.enable("yarc")` reads this file. Not tried with 0.11 itself.
return {
  cmd = { "yarc", "lsp" },
  filetypes = { "yarc" },
  root_markers = { "yarc.toml", ".git" },
}
