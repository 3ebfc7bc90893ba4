;;; Opens a program as a user does, waits for the findings, applies the first fix, saves, and tells all of it as JSON.  -*- lexical-binding: t; -*-

(require 'json)
(require 'flymake)
(require 'eglot)
(require 'yarc-mode)
(setq yarc-program (getenv "YARC_TEST_PROGRAM")
      eglot-sync-connect 60
      eglot-connect-timeout 60
      eglot-confirm-server-initiated-edits nil
      make-backup-files nil
      create-lockfiles nil)

(defun told-findings ()
  (vconcat (mapcar (lambda (one)
                     (list (cons 'line (line-number-at-pos (flymake-diagnostic-beg one)))
                           (cons 'text (flymake-diagnostic-text one))))
                   (flymake-diagnostics))))

(defun wait-for (condition)
  "Give processes and timers their turn until CONDITION holds, at most half a minute."
  (let ((end (+ (float-time) 30)))
    (while (and (not (funcall condition)) (< (float-time) end))
      (flymake-start)
      (accept-process-output nil 0.1))
    (funcall condition)))

(find-file (getenv "YARC_TEST_FILE"))
(apply #'eglot (eglot--guess-contact))
(flymake-mode 1)
(let* ((shown (wait-for #'flymake-diagnostics))
       (before (told-findings)))
  (when shown
    (goto-char (flymake-diagnostic-beg (car (flymake-diagnostics))))
    ;; as the command does it where there is one fix
    (eglot-code-actions (line-beginning-position) (line-end-position) "quickfix" t))
  ;; changes are sent when Emacs is idle, which it never is in batch; or when a buffer is saved
  (save-buffer)
  (let ((cleared (wait-for (lambda () (null (flymake-diagnostics))))))
    (with-temp-file (getenv "YARC_TEST_OUT")
      (insert (json-encode (list (cons 'mode (with-current-buffer (find-buffer-visiting (getenv "YARC_TEST_FILE"))
                                               (symbol-name major-mode)))
                                 (cons 'before before)
                                 (cons 'cleared (if cleared t :json-false))))))))
(kill-emacs 0)
