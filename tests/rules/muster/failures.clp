; SPDX-License-Identifier: Apache-2.0
; options: library=no failures=3
; A rule that fails three times is enough; the count is each rule's own, and never ends the others.
(defrule bad (position ?time $?) => (bind ?v (nth$ 1 (create$ fast))) (setSpeed ?v 0))
(defrule worse (declare (salience 5)) (position $?) (go) => (div 1 (- 1 1)))
(defrule fine (position $?) => (stop))

; line: (failures)
; expect: ()
; acts: on
; step:
; expect: rule bad (tests/rules/muster/failures.clp:4): [MUSTER1] Function setSpeed expected a number as argument #1, and got the symbol fast 
; expect: speed 0 0
; expect: idle, 2 fired, 1 errors: bad fine
; line: (assert (go))
; expect: <Fact-3>
; step:
; expect: rule worse (tests/rules/muster/failures.clp:5): [MUSTER1] Function div expected no division by zero 
; expect: rule bad (tests/rules/muster/failures.clp:4): [MUSTER1] Function setSpeed expected a number as argument #1, and got the symbol fast 
; expect: speed 0 0
; expect: idle, 3 fired, 2 errors: worse bad fine
; step:
; expect: speed 0 0
; expect: idle, 3 fired, 2 errors: worse bad fine
; expect: enough: rule bad failed 3 times
; line: (failures)
; expect: (bad 3 worse 2)
