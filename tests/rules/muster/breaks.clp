; SPDX-License-Identifier: Apache-2.0
;
; options: library=no
;
; A rule with a breakpoint: rules stop before it, and go on when somebody says so.

(deffacts beginning (n 1) (n 2))

(defrule first
  (declare (salience 10))
  (go)
  (n ?x)
  =>)

(defrule second
  (go)
  (n ?x)
  =>
  (printout t "second " ?x crlf))

; acts: on
; line: (break second)
; line: (assert (go))
; expect: <Fact-3>
; step:
; expect: break second, 2 fired, 0 errors: first first
; A step without being told to go on stays where it is.
; step:
; expect: break second, 0 fired, 0 errors:
; line: (continue)
; expect: TRUE
; expect: wants to run
; The other activation stops again.
; step:
; expect: second 2
; expect: break second, 1 fired, 0 errors: second
; line: (set-break first)
; line: (show-breaks)
; expect: first
; expect: second
; line: (remove-break second)
; step:
; expect: second 1
; expect: idle, 1 fired, 0 errors: second
; line: (assert (n 3))
; expect: <Fact-12>
; line: (remove-break)
; step:
; expect: second 3
; expect: idle, 2 fired, 0 errors: first second
; CLIPS's own break still leaves a loop, and a line has no loop.
; line: (loop-for-count (?i 3) do (printout t ?i crlf) (break))
; expect: 1
; expect: FALSE
; line: (break nobody)
; expect: [PRNTUTIL1] Unable to find defrule nobody.
