; SPDX-License-Identifier: Apache-2.0
; The library's timers count simulated time; a step of the test is 0.1 s, the first one is at 0.
(defrule rings
  (declare (salience 60))
  ?t <- (timeout ?word&:(symbolp ?word) $?rest)
  =>
  (retract ?t)
  (printout t (create$ ?word ?rest) " " (round (* 10 (now))) crlf))

(deffunction say ($?words)
  (printout t "says " ?words " " (round (* 10 (now))) crlf))

; line: (after 0.3 tea is ready)
; expect: (tea is ready)
; steps: 3
; step:
; expect: (tea is ready) 3
; line: (every 0.2 tick)
; expect: (tick)
; steps: 5
; expect: (tick) 5
; expect: (tick) 7
; line: (cancel tick) (after 0.1 over)
; expect: (over)
; steps: 4
; expect: (over) 9
; a string that is a call is evaluated
; line: (after 0.2 "(say hello there)")
; expect: ("(say hello there)")
; steps: 3
; expect: says (hello there) 14
; what (after) returns ends the timer
; line: (progn (bind ?id (after 0.2 "(say never)")) (cancel ?id))
; steps: 4
; timers outlive (reset)
; line: (every 0.2 again) (reset)
; expect: (again)
; steps: 3
; expect: (again) 21
; where times were missed, as in a long sleep, there is one, and then the next
; line: (progn (cancel again) (assert (timer 0.0 0.5 late)))
; expect: <Fact-10>
; steps: 7
; expect: (late) 23
; expect: (late) 25
