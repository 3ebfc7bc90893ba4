-- YARC in Neovim (0.7 or newer): starts the language server for programs.
--
--   require("yarc").setup()                                        yarc is on the PATH
--   require("yarc").setup({ path = "/opt/venv/bin/yarc", robot = "INDUSTRIAL6" })

local M = { options = { path = "yarc", robot = nil, on_attach = nil } }
local clients = {}

local function command()
  local cmd = { M.options.path, "lsp" }
  if M.options.robot then
    vim.list_extend(cmd, { "--robot", M.options.robot })
  end
  return cmd
end

-- The folder of the nearest yarc.toml above a file, else its own.
local function root_of(file)
  local folder = vim.fn.fnamemodify(file, ":p:h")
  local found = vim.fn.findfile("yarc.toml", vim.fn.escape(folder, " ;,") .. ";")
  return found ~= "" and vim.fn.fnamemodify(found, ":p:h") or folder
end

-- Attach the server of a program's folder; the first program there starts it.
function M.start(buffer)
  local root = root_of(vim.api.nvim_buf_get_name(buffer))
  local client = clients[root]
  if not client or not vim.lsp.get_client_by_id(client) then
    client = vim.lsp.start_client({
      name = "yarc",
      cmd = command(),
      root_dir = root,
      on_attach = M.options.on_attach,
      on_exit = function()
        clients[root] = nil
      end,
    })
    clients[root] = client
  end
  if client then
    vim.lsp.buf_attach_client(buffer, client)
  end
  return client
end

function M.setup(options)
  M.options = vim.tbl_extend("force", M.options, options or {})
  local group = vim.api.nvim_create_augroup("yarc", { clear = true })
  vim.api.nvim_create_autocmd("FileType", {
    group = group,
    pattern = "yarc",
    callback = function(event)
      M.start(event.buf)
    end,
  })
end

return M
