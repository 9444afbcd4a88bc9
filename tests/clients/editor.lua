-- What editor.sh lets Neovim ask.
local function fail(text)
  io.stderr:write('editor: ' .. text .. '\n')
  os.exit(1)
end

local function expect(what, found, wanted)
  local text = type(found) == 'string' and found or vim.inspect(found)
  if not text:find(wanted, 1, true) then
    fail(what .. ': `' .. wanted .. '` is not in ' .. text)
  end
end

local function run()
  vim.cmd.edit('in.plate')
  if vim.bo.filetype ~= 'perigrain' then
    fail('in.plate is taken for ' .. vim.bo.filetype)
  end
  vim.cmd('syntax on')
  for _, part in ipairs({ { 1, 1, 'Flow' }, { 1, 22, 'Number' }, { 1, 24, 'Comment' }, { 3, 1, 'Command' }, { 3, 7, 'String' }, { 3, 9, 'Value' } }) do
    local name = vim.fn.synIDattr(vim.fn.synID(part[1], part[2], 1), 'name')
    expect(('colour of line %d, column %d'):format(part[1], part[2]), name, 'perigrain' .. part[3])
  end
  local function there(what, test)
    if not vim.wait(20000, test, 20) then
      fail(what .. ' does not come')
    end
  end
  there('the server', function() return #vim.lsp.get_clients({ bufnr = 0 }) > 0 end)
  there('a message', function() return #vim.diagnostic.get(0) > 0 end)
  expect('message', vim.diagnostic.get(0)[1].message, 'did you mean `pair_style`?')

  local client = vim.lsp.get_clients({ bufnr = 0 })[1]
  local function ask(method, line, column, more)
    vim.api.nvim_win_set_cursor(0, { line, column })
    local params = vim.lsp.util.make_position_params(0, client.offset_encoding)
    local answer = client:request_sync(method, vim.tbl_extend('force', params, more or {}), 20000, 0)
    if not answer or answer.err then
      fail(method .. ': ' .. vim.inspect(answer))
    end
    return answer.result
  end
  expect('hover', ask('textDocument/hover', 1, 2), 'variable NAME')
  expect('completion', ask('textDocument/completion', 2, 6), 'pair_style')
  expect('outline', ask('textDocument/documentSymbol', 1, 0), 'speed')
  vim.api.nvim_win_set_cursor(0, { 3, 10 })
  vim.lsp.buf.rename('pace')
  local function line(k) return vim.api.nvim_buf_get_lines(0, k - 1, k, true)[1] end
  there('rename', function() return line(3) == 'print "${pace}"' and line(1):find('variable pace', 1, true) == 1 end)
  vim.api.nvim_win_set_cursor(0, { 2, 3 })
  vim.lsp.buf.code_action({ apply = true })
  there('quick fix', function() return line(2) == 'pair_style  zero 1.0' end)
  vim.lsp.buf.format({ timeout_ms = 20000 })
  there('layout', function() return line(2) == 'pair_style zero 1.0' end)
  print('editor: Neovim gets colours, messages, help, completion, outline, names, quick fixes and layout\n')
  vim.cmd('qall!')
end

local ok, why = xpcall(run, debug.traceback)
if not ok then
  fail(why)
end
