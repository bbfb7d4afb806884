; SPDX-License-Identifier: Apache-2.0
;
; (follow-wall left), (follow-wall right): goes along what is at that side, ?*wall-far* mm from it.
; Where nothing is near it goes straight on until something is.

(defglobal
  ?*wall-far* = 450     ; mm between the sonars of that side and the wall
  ?*wall-speed* = 250   ; mm/s
  ?*wall-ahead* = 550)  ; mm: with less room ahead it turns away

(deffunction follow-wall (?side)
  (new-goal wall ?side))

(deffunction wall-ahead ()
  (min (range 2 5000) (range 3 5000) (range 4 5000) (range 5 5000)))

(deffunction wall-beside (?side)
  "How far the wall is, as the sonar to the side and the one ahead of it see it; that one looks
   40 deg ahead, so it sees a wall that bends away sooner."
  (if (eq ?side left)
   then (min (range 0 5000) (* 0.77 (range 1 5000)))
   else (min (range 7 5000) (* 0.77 (range 6 5000)))))

; Avoidance wins: what is ahead is turned away from, on the spot.
(defrule wall-turn
  (declare (salience 5))
  (goal wall ?side)
  (position ?time ?x ?y ? ? ?compass ?)
  (test (< (wall-ahead) ?*wall-ahead*))
  =>
  (setSpeed (if (< (wall-ahead) 300) then -40 else 20) (if (eq ?side left) then -60 else 60))
  (update-sensors)
  (tell-position ?x ?y))

; Positive is towards the wall.  Round a corner it goes in a curve.
(defrule wall
  (goal wall ?side)
  (position ?time ?x ?y ? ? ?compass ?)
  =>
  (bind ?beside (wall-beside ?side))
  (bind ?turn (if (> ?beside 2500) then 0 else (clamp (* 0.09 (- ?beside ?*wall-far*)) -35 35)))
  (setSpeed (- ?*wall-speed* (* 3 (abs ?turn))) (if (eq ?side left) then ?turn else (- 0 ?turn)))
  (update-sensors)
  (tell-position ?x ?y))
