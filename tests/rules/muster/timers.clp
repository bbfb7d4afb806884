; SPDX-License-Identifier: Apache-2.0
; The library's timers count simulated time; a step of the test is 0.1 s, the first one is at 0.
(defrule rings
  (declare (salience 60))
  ?t <- (timeout $?what)
  =>
  (retract ?t)
  (printout t ?what " " (round (* 10 (now))) crlf))

; line: (after 0.3 tea is ready)
; expect: <Fact-1>
; steps: 3
; step:
; expect: (tea is ready) 3
; line: (every 0.2 tick)
; expect: <Fact-11>
; steps: 5
; expect: (tick) 5
; expect: (tick) 7
; line: (cancel tick) (after 0.1 over)
; expect: <Fact-26>
; steps: 4
; expect: (over) 9
