; SPDX-License-Identifier: Apache-2.0
; Scripts that CLIPS runs as a program and inside a robot: tests/rules/engine/run.

;;; joined
(defrule r
  =>
  (printout t (str-cat a "b" 1 2.5 [c]) crlf)
  (printout t (sym-cat a "b" 3) crlf)
  (printout t (str-cat "") crlf))

;;; case
(defrule r
  =>
  (printout t (upcase "aBc") crlf)
  (printout t (lowcase "aBc") crlf)
  (printout t (upcase aBc) crlf)
  (printout t (lowcase XyZ) crlf))

;;; parts
(defrule r
  =>
  (printout t (sub-string 2 4 "abcdef") crlf)
  (printout t (sub-string 4 2 "abcdef") crlf)
  (printout t (str-length "abc") crlf)
  (printout t (str-length abc) crlf))

;;; search
(defrule r
  =>
  (printout t (str-index "cd" "abcdef") crlf)
  (printout t (str-index x "abc") crlf)
  (printout t (str-index a "abc") crlf)
  (printout t (str-index "" "abc") crlf))

;;; order
(defrule r
  =>
  (printout t (str-compare "abc" "abd") crlf)
  (printout t (str-compare "b" "a") crlf)
  (printout t (str-compare "a" "a") crlf))

;;; formats
(defrule r
  =>
  (printout t (format nil "%5d|%-5d|%05d" 42 42 42) crlf)
  (printout t (format nil "%8.3f|%e|%g" 3.14159 31415.9 0.0001) crlf)
  (printout t (format nil "%s|%10s|%-10s|" a b c) crlf))

;;; more formats
(defrule r
  =>
  (printout t (format nil "%x %o %%" 255 8) crlf)
  (printout t (format nil "%n%r") crlf)
  (printout t (format nil "plain") crlf))

;;; kinds
(defrule r
  =>
  (printout t (stringp "a") crlf)
  (printout t (stringp a) crlf)
  (printout t (symbolp a) crlf)
  (printout t (lexemep "a") crlf)
  (printout t (lexemep 3) crlf)
  (printout t (multifieldp (create$ a)) crlf))

;;; escapes
(defrule r
  =>
  (printout t "a \"quoted\" word" crlf)
  (printout t "back\\slash" crlf)
  (printout t "tab	and" crlf))

;;; to fields
(defrule r
  =>
  (printout t (explode$ "a 1 2.5 \"s t\"") crlf)
  (printout t (implode$ (create$ a 1 2.5 "s t")) crlf)
  (printout t (string-to-field "3.5 x") crlf)
  (printout t (string-to-field "") crlf))

;;; evaluated
(defrule r
  =>
  (printout t (eval "(+ 1 2)") crlf)
  (printout t (eval "abc") crlf)
  (printout t (eval "(create$ 1 2)") crlf))

;;; built
(defrule r
  =>
  (printout t (build "(defrule made (declare (salience -1)) => (printout t made crlf))") crlf))

;;; symbols
(defrule r
  =>
  (printout t (symbolp (gensym)) crlf)
  (printout t TRUE crlf)
  (printout t nil crlf)
  (printout t crlf-x crlf)
  (printout t a.b-c_d crlf))

;;; formats of all kinds
(defrule go =>
  (printout t (format nil "[%05s][%05c][%-05d][%07.2f][%05.3d][%0x][%.3s][%.0f][%.f][%5%d]"
                      ab a 42 -3.14159 7 255 abcdef 2.5 3.5 1) crlf)
  (printout t (format nil "[%c][%5c][%-5c]" 65 bcd "e") crlf)
  (printout t (format nil "[%--5d][%-08d][%0-8d][%.05d]" 5 6 7 8) crlf)
  (printout t (format nil "[%d][%u][%n%t%v%%]" -7.9 -1) crlf)
  (printout t (format nil "[%-5") (format nil "%") (format nil "") crlf)
  (printout t (format nil "[%012.3f|%-12g|%012e]" -1.5 2 3) crlf)
  (format t "[%s]%n" done))
