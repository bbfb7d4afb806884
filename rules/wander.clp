; SPDX-License-Identifier: Apache-2.0
;
; (wander): drives about in large curves, keeps clear of everything.

(defglobal
  ?*wander-speed* = 270   ; mm/s: followers must be able to close up
  ?*wander-sight* = 1250  ; mm: with less room ahead it turns
  ?*wander-turn* = 20     ; deg to the side then
  ?*wander-want* = 0      ; deg to the side otherwise
  ?*wander-until* = -1.0) ; s: then it changes its mind

(deffunction wander ()
  (new-goal safe-wander))

(deffunction change-mind (?time)
  (bind ?*wander-want* (random -7 7))
  (bind ?*wander-until* (+ ?time (random 4 9))))

(deffunction better-side (?turn-rate)
  "1: left, -1: right.  The side to which it turns already, else the freer one."
  (if (> (abs ?turn-rate) 15)
   then (if (> ?turn-rate 0) then 1 else -1)
   else (freer-side)))

(defrule safe-wander
  (goal safe-wander)
  (position ?time ?x ?y ? ?turn-rate ?compass ?)
  =>
  (if (>= ?time ?*wander-until*) then
    (change-mind ?time))
  (bind ?want ?*wander-want*)
  (if (< (nth$ 2 (clear-way 0)) ?*wander-sight*) then
    (bind ?want (* ?*wander-turn* (better-side ?turn-rate))))
  (steer ?*wander-speed* (detour ?time ?x ?y ?compass ?want) 5000)
  (update-sensors)
  (tell-position ?x ?y))
