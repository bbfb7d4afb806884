; SPDX-License-Identifier: Apache-2.0
; A rule file takes in another and the library, and overrides by name.
(extends "parts/base.clp")

(deffunction greeting () "hello from the file")

(defrule stay
  (goal stay)
  (position $?)
  =>
  (printout t "my own stay, " (greeting) crlf))

; acts: on
; step:
; expect: my own stay, hello from the file
; expect: idle, 1 fired, 0 errors: stay
; line: ?*base*
; expect: 7
; line: ?*my-name* ?*mate*
; expect: expected nothing more, or one more form in parentheses: ?*mate*
; expect: refused
; line: (bind ?*mate* red) (bind ?*my-name* cyan) (bind ?*base* 8) (reset)
; expect: red
; expect: cyan
; expect: 8
; line: (create$ ?*mate* ?*my-name* ?*base*)
; expect: (red cyan 7)
