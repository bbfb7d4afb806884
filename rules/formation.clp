; SPDX-License-Identifier: Apache-2.0
;
; (formation KIND LEADER PLACE): keeps a place, counted from 1, in a formation round a robot that tells
; where it is: `column` behind it, `line` beside it (left, right, left, ...), `circle` round it.  The
; leader is told nothing; which way it looks is how it last went.

(defglobal
  ?*formation-step* = 1000    ; mm from one place to the next
  ?*formation-radius* = 1300  ; mm of the circle
  ?*formation-size* = 6       ; places on it
  ?*formation-speed* = 450    ; mm/s at most
  ?*leader-x* = 0             ; where the leader was when it had last gone a bit,
  ?*leader-y* = 0
  ?*leader-way* = FALSE)      ; and the direction that it went, in deg; FALSE: it has not gone yet

(deffunction formation (?kind ?leader ?place)
  (progn$ (?old (findall (message mate-pos $?)))
    (retract ?old))
  (bind ?*mate* ?leader)
  (bind ?*leader-way* FALSE)
  (bind ?*leader-x* 0)
  (bind ?*leader-y* 0)
  (new-goal formation ?kind ?place))

(deffunction leader-went (?x ?y)
  (if (> (distance ?x ?y ?*leader-x* ?*leader-y*) 150) then
    (bind ?way (bearing ?*leader-x* ?*leader-y* ?x ?y))
    (bind ?*leader-way* (if ?*leader-way*
      then (norm-angle (+ ?*leader-way* (* 0.6 (norm-angle (- ?way ?*leader-way*)))))
      else ?way))
    (bind ?*leader-x* ?x)
    (bind ?*leader-y* ?y)))

(deffunction formation-place (?kind ?place ?way)
  "Direction and distance of a place, seen from the leader."
  (switch ?kind
    (case line then
      (create$ (+ ?way (if (oddp ?place) then 90 else -90))
               (* ?*formation-step* (div (+ ?place 1) 2))))
    (case circle then
      (create$ (/ (* 360 ?place) ?*formation-size*) ?*formation-radius*))
    (default
      (create$ (+ ?way 180) (* ?*formation-step* ?place)))))

(defrule formation
  (declare (salience 2))
  (goal formation ?kind ?place)
  (message mate-pos ?*mate* ?mate-x ?mate-y)
  (position ?time ?x ?y ? ? ?compass ?)
  =>
  (leader-went ?mate-x ?mate-y)
  (bind ?way (if ?*leader-way* then ?*leader-way* else (bearing ?x ?y ?mate-x ?mate-y)))
  (bind ?at (formation-place ?kind ?place ?way))
  (bind ?to-x (+ ?mate-x (* (nth$ 2 ?at) (cosd (nth$ 1 ?at)))))
  (bind ?to-y (+ ?mate-y (* (nth$ 2 ?at) (sind (nth$ 1 ?at)))))
  (bind ?far (distance ?x ?y ?to-x ?to-y))
  (bind ?aside (aside ?x ?y ?compass ?to-x ?to-y))
  (if (< ?far 120)
   then (standing ?time ?x ?y)
        (stop)
   else (steer (clamp (* 0.9 ?far) 60 ?*formation-speed*)
               (detour ?time ?x ?y ?compass ?aside) ?far))
  (update-sensors)
  (tell-position ?x ?y))

; The leader has not said anything yet, or not for a long time.
(defrule formation-wait
  (declare (salience -10))
  (goal formation $?)
  (position ? ?x ?y $?)
  =>
  (stop)
  (update-sensors)
  (tell-position ?x ?y))
