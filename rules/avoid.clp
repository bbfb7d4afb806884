; SPDX-License-Identifier: Apache-2.0
;
; Steering round obstacles, and getting free again.
; Angles are relative to the robot, in degrees, left is positive; lengths are in mm.

(defglobal
  ?*steer-turn* = 70      ; deg/s at most
  ?*steer-room* = 700     ; with less room ahead than this, slower
  ?*mark-time* = 0.0      ; s: where the robot was then
  ?*mark-x* = 0.0
  ?*mark-y* = 0.0
  ?*detour-until* = -1.0  ; s
  ?*detour-way* = 0.0)    ; deg, a compass direction

(deffunction steer (?speed ?want ?far)
  "Drives at most this fast in the wanted direction, round what is nearer than far.
   Returns the direction that it takes."
  (bind ?way (clear-way ?want ?far))
  (bind ?direction (nth$ 1 ?way))
  (bind ?slower (min 1 (/ (nth$ 2 ?way) ?*steer-room*)))
  (setSpeed (* ?speed ?slower (max 0 (cosd ?direction)))
            (clamp (* 1.5 ?direction) (- 0 ?*steer-turn*) ?*steer-turn*))
  ?direction)

(deffunction aside (?x ?y ?compass ?to-x ?to-y)
  "How far to the side a point is."
  (norm-angle (- (bearing ?x ?y ?to-x ?to-y) ?compass)))

(deffunction standing (?time ?x ?y)
  "Standing still is wanted: no reason for a detour."
  (bind ?*mark-time* ?time)
  (bind ?*mark-x* ?x)
  (bind ?*mark-y* ?y))

(deffunction plan-detour (?time ?compass ?aside)
  (bind ?*detour-until* (+ ?time (* 0.1 (random 30 70))))
  (bind ?*detour-way* (+ ?compass ?aside (* (random 60 140) (- (* 2 (random 0 1)) 1)))))

(deffunction detour (?time ?x ?y ?compass ?aside)
  "The direction to take: the wanted one, or for a while another if there was no way on."
  (if (> (- ?time ?*mark-time*) 5) then
    (if (< (distance ?x ?y ?*mark-x* ?*mark-y*) 200) then
      (plan-detour ?time ?compass ?aside))
    (standing ?time ?x ?y))
  (if (< ?time ?*detour-until*) then (norm-angle (- ?*detour-way* ?compass)) else ?aside))

(deffunction range (?i ?otherwise)
  "What that sonar says, if the body has it."
  (sonar ?i ?otherwise))

(deffunction freer-side ()
  "1: there is more room at the left, -1: at the right."
  (bind ?left (min (range 0 5000) (range 1 5000) (range 2 5000)))
  (bind ?right (min (range 5 5000) (range 6 5000) (range 7 5000)))
  (if (> ?left ?right) then 1 else -1))

; Held up: whatever the goal is, get free first, at each try a little different.
(defrule held-up
  (declare (salience 30))
  (goal ~stay $?)
  (position ?time ? ? ? ? ? TRUE)
  (not (escaping $?))
  =>
  (assert (escaping (+ ?time 1.2 (* 0.1 (random 0 8))) (freer-side))))

; Back off while there is room behind, then turn.
(defrule escape
  (declare (salience 20))
  (escaping ?until ?side)
  (position ?time&:(< ?time ?until) ?x ?y $?)
  =>
  (if (and (> (- ?until ?time) 0.7) (> (min (range 11 0) (range 12 0)) 150))
   then (setSpeed -160 (* 15 ?side))
   else (setSpeed 0 (* 60 ?side)))
  (update-sensors)
  (tell-position ?x ?y))

(defrule escaped
  (declare (salience 40))
  ?escaping <- (escaping ?until ?)
  (position ?time&:(>= ?time ?until) $?)
  =>
  (retract ?escaping))
