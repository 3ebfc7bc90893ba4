autocmd BufRead,BufNewFile *.yarc setfiletype yarc
