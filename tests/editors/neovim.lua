-- Opens a program as a user does, waits for the findings, applies the first fix, writes, and tells all of it as JSON.
local out = vim.env.YARC_TEST_OUT
local told = { filetype = vim.bo.filetype }

local function findings()
  return vim.tbl_map(function(one)
    return { line = one.lnum + 1, code = one.code, message = one.message, severity = one.severity }
  end, vim.diagnostic.get(0))
end

vim.wait(60000, function()
  return #vim.diagnostic.get(0) > 0
end, 50)
told.before = findings()

local line = vim.diagnostic.get(0)[1] and vim.diagnostic.get(0)[1].lnum or 0
vim.api.nvim_win_set_cursor(0, { line + 1, 0 })
local params = vim.lsp.util.make_range_params()
params.range = { start = { line = line, character = 0 }, ["end"] = { line = line, character = 200 } }
params.context = { diagnostics = vim.lsp.diagnostic.get_line_diagnostics(0, line), only = { "quickfix" } }
local answers = vim.lsp.buf_request_sync(0, "textDocument/codeAction", params, 60000) or {}
told.actions = {}
for id, answer in pairs(answers) do
  for _, action in ipairs(answer.result or {}) do
    table.insert(told.actions, action.title)
    if #told.actions == 1 then
      local client = vim.lsp.get_client_by_id(id)
      vim.lsp.util.apply_workspace_edit(action.edit, client.offset_encoding)
    end
  end
end
told.cleared = vim.wait(60000, function()
  return #vim.diagnostic.get(0) == 0
end, 50)
told.after = findings()

local hover = vim.lsp.buf_request_sync(0, "textDocument/hover", vim.lsp.util.make_position_params(), 60000) or {}
for _, answer in pairs(hover) do
  told.hover = answer.result and answer.result.contents
end
vim.cmd("silent write")
local file = io.open(out, "w")
file:write(vim.fn.json_encode(told))
file:close()
vim.cmd("qall!")
