; SPDX-License-Identifier: Apache-2.0
; options: body=no
; An agent without a body has the time and timers, and no percepts.
(defrule clock
  (time ?t&:(< ?t 0.15))
  =>
  (printout t "time " ?t crlf))

(defrule sees
  (position $?)
  =>
  (printout t "a position" crlf))

(deffunction say ($?words)
  (printout t ?words " " (round (* 10 (now))) crlf))

; step:
; expect: time 0.0
; step:
; expect: time 0.1
; line: (every 0.2 "(say again)") (after 0.3 "(say once)")
; expect: ("(say again)")
; expect: ("(say once)")
; steps: 4
; expect: (again) 3
; expect: (once) 4
; expect: (again) 5
; line: (cancel "(say again)")
; steps: 3
; what needs a body says so, and no more
; line: (position)
; expect: [MUSTER1] Function position expected a body, and this agent has none
; expect: ()
; expect: refused
; line: (setSpeed 100 0)
; expect: [MUSTER1] Function setSpeed expected a body, and this agent has none
; expect: FALSE
; expect: refused
; line: (sonar 3)
; expect: [MUSTER1] Function sonar expected a body, and this agent has none
; expect: FALSE
; expect: refused
; line: (gripper open)
; expect: [MUSTER1] Function gripper expected a body, and this agent has none
; expect: ()
; expect: refused
; line: (plan 1000 1000)
; expect: [MUSTER1] Function plan expected a body, and this agent has none
; expect: FALSE
; expect: refused
; line: (laser)
; expect: [MUSTER1] Function laser expected a body, and this agent has none
; expect: FALSE
; expect: refused
; line: (distance 0 0 3 4)
; expect: 5.0
; line: (my-name)
; expect: blue
; facts: time
; expect: f-24    (time 0.8)
; expect: For a total of 1 fact.
