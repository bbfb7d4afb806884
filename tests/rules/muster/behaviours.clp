; SPDX-License-Identifier: Apache-2.0
; The library's commands; how well they drive is the matter of tests/unit/mind/behaviour.c.
(deffunction goals ()
  (progn$ (?g (findall (goal $?))) (printout t (fact-fields ?g) crlf)))

; acts: on
; line: (wander) (goals)
; expect: <Fact-1>
; expect: (safe-wander)
; line: (bind ?*wander-until* 99)
; expect: 99
; step: x=100 y=200
; expect: mail all "mate-pos blue 100 200"
; expect: speed 270 0
; expect: sense-again, 1 fired, 0 errors: safe-wander
; line: (follow red) (goals) ?*mate*
; expect: expected nothing more, or one more form in parentheses: ?*mate*
; expect: refused
; line: (follow red) (goals) (progn ?*mate*)
; expect: <Fact-4>
; expect: (follow)
; expect: red
; step:
; expect: mail all "mate-pos blue 100 200"
; expect: speed 0 0
; expect: sense-again, 1 fired, 0 errors: wait-for-mate
; mail: green mate-pos green 100.0 2200.0
; step:
; expect: mail all "mate-pos blue 100 200"
; expect: speed 0 0
; expect: sense-again, 1 fired, 0 errors: wait-for-mate
; mail: red mate-pos red 3100.0 200.0
; step:
; expect: mail all "mate-pos blue 100 200"
; expect: speed 450 0
; expect: sense-again, 1 fired, 0 errors: follow-robot
;
; The leader becomes a follower of another: only what green says counts from now on.
; line: (follow green)
; expect: <Fact-13>
; mail: green mate-pos green 100.0 2200.0
; step: heading=90
; expect: mail all "mate-pos blue 100 200"
; expect: speed 450 0
; expect: sense-again, 1 fired, 0 errors: follow-robot
; step: s3=300 s4=300
; expect: mail all "mate-pos blue 100 200"
; expect: speed 20.661 70
; expect: sense-again, 1 fired, 0 errors: follow-robot
; line: (gohome 100 250)
; expect: <Fact-19>
; step:
; expect: mail all "mate-pos blue 100 200"
; expect: speed 0 0
; expect: sense-again, 1 fired, 0 errors: gohome-arrived
; line: (goals)
; expect: (stay)
; step: stalled=1
; expect: mail all "mate-pos blue 100 200"
; expect: speed 0 0
; expect: sense-again, 1 fired, 0 errors: stay
; line: (wander)
; expect: <Fact-25>
; step: s12=900 s11=900 s6=400
; expect: mail all "mate-pos blue 100 200"
; expect: speed -160 15
; expect: sense-again, 2 fired, 0 errors: held-up escape
