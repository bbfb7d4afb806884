; SPDX-License-Identifier: Apache-2.0
; options: library=no
; (clear-way want [far]): the direction to take, and the room ahead.

; line: (clear-way 20)
; expect: (20.0 4750.0)
; step:
; line: (clear-way 0) (clear-way 20) (clear-way -200)
; expect: (0.0 4750.0)
; expect: (20.0 4750.0)
; expect: (90.0 4750.0)
;
; Something ahead: round it, unless it is behind the place to go to.
; step: s3=500 s4=500
; line: (clear-way 5) (clear-way -5) (clear-way 5 400)
; expect: (50.0 250.0)
; expect: (-50.0 250.0)
; expect: (5.0 4750.0)
;
; It keeps to the side to which it turns.
; step: turn=60
; line: (clear-way -5)
; expect: (50.0 250.0)
;
; What needs no care is a matter of ?*care*.
; line: (bind ?*care* 400) (clear-way -5)
; expect: 400
; expect: (-5.0 250.0)
; line: (bind ?*care* far) (clear-way -5)
; expect: far
; expect: (50.0 250.0)
;
; Aside counts less; close at one side, it leans to the other.
; step: turn=0 sonar=5000 s1=1000 s7=250
; line: (clear-way 0)
; expect: (19.5 3250.0)
;
; No room at all: never straight on.
; step: sonar=200
; line: (clear-way 0)
; expect: (27.0 0.0)
;
; line: (clear-way)
; expect: [ARGACCES4] Function clear-way expected at least 1 argument(s)
; expect: refused
; line: (clear-way left)
; expect: [ARGACCES5] Function clear-way expected argument #1 to be of type integer or float
; expect: refused
