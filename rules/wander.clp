; SPDX-License-Identifier: Apache-2.0
;
; (wander): drives about, turns at random, keeps clear of everything.

(defglobal
  ?*wander-speed* = 270   ; mm/s: followers must be able to close up
  ?*wander-want* = 0      ; deg to the side
  ?*wander-until* = -1.0) ; s: then it changes its mind

(deffunction wander ()
  (new-goal safe-wander))

(deffunction change-mind (?time)
  (bind ?*wander-want* (if (= 0 (random 0 2)) then (random -35 35) else (random -8 8)))
  (bind ?*wander-until* (+ ?time (* 0.1 (random 15 50)))))

(defrule safe-wander
  (goal safe-wander)
  (position ?time ?x ?y $?)
  (sonar ? $?ring&:(>= (length$ ?ring) 8))
  =>
  (if (>= ?time ?*wander-until*) then
    (change-mind ?time))
  (steer ?*wander-speed* ?*wander-want* ?ring)
  (update-sensors)
  (tell-position ?x ?y))
