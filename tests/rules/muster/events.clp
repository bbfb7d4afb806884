; SPDX-License-Identifier: Apache-2.0
; options: library=no
; What the robot lives through, and what others may ask of its facts.
(defrule lives
  (event ?what)
  =>
  (printout t ?what crlf))

(defrule says-farewell
  (event on-dispose)
  =>
  (broadcast farewell))

; event: on-run
; event: on-create
; line: (findall (event $?))
; expect: ()
; step:
; expect: on-run
; expect: on-create
; step:
; facts: event
; expect: f-3     (event on-create)
; expect: f-4     (event on-run)
; expect: For a total of 2 facts.
; It begins to run anew: the fact is asserted anew.
; event: on-run
; step:
; expect: on-run
; event: on-arrive
; event: on-clone
; step:
; expect: on-clone
; expect: on-arrive
; The last ones are not for a later step.
; event: on-leave
; expect: on-leave
; event: on-dispose
; expect: on-dispose
; expect: mail all "farewell"
; line: (reset)
; facts:
; expect: f-0     (initial-fact)
; expect: For a total of 1 fact.
; facts: initial-fact
; expect: f-0     (initial-fact)
; expect: For a total of 1 fact.
; facts: no such thing
; expect: no facts no such thing
; expect: refused
; facts: event
; expect: For a total of 0 facts.
