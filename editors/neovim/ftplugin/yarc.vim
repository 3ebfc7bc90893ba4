" YARC programs: how comments begin, how far blocks are indented, and what `:make` says.
if exists('b:did_ftplugin')
  finish
endif
let b:did_ftplugin = 1
setlocal commentstring=!\ %s comments=:! shiftwidth=2 expandtab
setlocal makeprg=yarcc\ %:S errorformat=%f:%l:%c:\ %trror\ %m,%f:%l:%c:\ %tarning\ %m,%f:%l:%c:\ %tote\ %m,%-G%.%#
let b:undo_ftplugin = 'setlocal commentstring< comments< shiftwidth< expandtab< makeprg< errorformat<'
