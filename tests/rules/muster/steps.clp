; SPDX-License-Identifier: Apache-2.0
; options: budget=5
; Control steps: what ends one, and what belongs to it.
(deffacts start (mode nothing))

(defrule first (declare (salience 5))
  (mode sense) (position ?t $?)
  =>
  (printout t (update-sensors) (update-sensors) crlf)
  (setSpeed 100 10)
  (broadcast here ?t))

(defrule second
  (mode sense) (position $?)
  =>
  (printout t "must not fire: its percept is gone with the step" crlf))

(defrule keeps
  (mode sense) (note ?n)
  =>
  (printout t "note " ?n crlf))

(defrule spin
  ?m <- (mode spin ?n)
  =>
  (retract ?m)
  (assert (mode spin (+ ?n 1))))

(defrule bad (declare (salience 3))
  (mode bad ?x)
  =>
  (setSpeed ?x 0)
  (printout t "not reached" crlf))

(defrule good
  (mode bad ?)
  =>
  (printout t "the others go on" crlf))

(defrule halts (declare (salience 9)) ?m <- (mode halt) => (retract ?m) (assert (mode nothing)) (halt))

; acts: on
; step:
; expect: idle, 0 fired, 0 errors:
; line: (new-goal stay) (undefrule stay) (undefrule escape)
; expect: <Fact-4>
; line: (progn$ (?m (findall (mode $?))) (retract ?m)) (assert (mode sense)) (assert (note 1))
; expect: <Fact-5>
; expect: <Fact-6>
; step:
; expect: TRUETRUE
; expect: mail all "here 0.10000000000000001"
; expect: speed 100 10
; expect: sense-again, 1 fired, 0 errors: first
;
; The activation on the note has stayed; with first out of the way it comes to its turn.
; line: (undefrule first) (undefrule second)
; step:
; expect: note 1
; expect: idle, 1 fired, 0 errors: keeps
;
; line: (assert (mode spin 0))
; expect: <Fact-11>
; step:
; expect: budget, 5 fired, 0 errors: spin spin spin spin spin
; step:
; expect: budget, 5 fired, 0 errors: spin spin spin spin spin
; line: (findall (mode spin 10))
; expect: (<Fact-25>)
; line: (undefrule spin) (assert (mode bad fast))
; expect: <Fact-26>
; step:
; expect: rule bad (tests/rules/muster/steps.clp:29): [MUSTER1] Function setSpeed expected a number as argument #1, and got the symbol fast 
; expect: the others go on
; expect: idle, 2 fired, 1 errors: bad good
;
; The same complaint of the same rule is shown once.
; line: (assert (mode bad slow))
; expect: <Fact-29>
; step:
; expect: rule bad (tests/rules/muster/steps.clp:29): [MUSTER1] Function setSpeed expected a number as argument #1, and got the symbol slow 
; expect: the others go on
; expect: idle, 2 fired, 1 errors: bad good
; line: (update-sensors)
; expect: FALSE
; line: (setSpeed 50 0)
; expect: TRUE
; step:
; expect: speed 50 0
; expect: idle, 0 fired, 0 errors:
; line: (assert (mode halt))
; expect: <Fact-34>
; step:
; expect: idle, 1 fired, 0 errors: halts
; line: (run)
; expect: TRUE
; expect: wants to run
; line: (run 10)
; expect: TRUE
; expect: wants to step
; line: (resume)
; expect: TRUE
; expect: wants to run
; line: (continue)
; expect: TRUE
; expect: wants to run
; line: (step)
; expect: TRUE
; expect: wants to step
; line: (suspend)
; expect: TRUE
; expect: wants to suspend
; line: (step 0)
; expect: [MUSTER1] Function step expected a number of rules, from 1 on
; expect: FALSE
; expect: refused
