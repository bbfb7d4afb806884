; SPDX-License-Identifier: Apache-2.0
;
; (follow NAME): goes where that robot says it is, and stays ?*follow-distance* mm behind it.
; The rule bears the name of the paper's, so that a rule file with that one replaces it.

(defglobal
  ?*follow-speed* = 450  ; mm/s at most
  ?*follow-pace* = 100   ; mm/s at least, while the mate moves
  ?*mate-x* = 0          ; where it was in the last step
  ?*mate-y* = 0)

(deffunction follow (?name)
  "Forgets what others said before: a global in a pattern is looked at only when mail comes."
  (progn$ (?old (findall (message mate-pos $?)))
    (retract ?old))
  (bind ?*mate* ?name)
  (new-goal follow))

(deffunction mate-moves (?mate-x ?mate-y)
  (bind ?way (distance ?mate-x ?mate-y ?*mate-x* ?*mate-y*))
  (bind ?*mate-x* ?mate-x)
  (bind ?*mate-y* ?mate-y)
  (> ?way 2))

(deffunction follow-speed (?far ?moves)
  "mm/s: the faster the farther."
  (clamp (- ?far ?*follow-distance* -280) (if ?moves then ?*follow-pace* else 0) ?*follow-speed*))

(deffunction pass-by (?far)
  "Degrees to keep to the right of a mate that is near: so those who follow each other in a ring
   go round and round, and nobody pushes."
  (clamp (* 0.6 (- ?*follow-distance* ?far)) 0 90))

; Go to the mate, round what is before it.
(defrule follow-robot
  (declare (salience 2))
  (goal follow)
  (message mate-pos ?*mate* ?mate-x ?mate-y)
  (position ?time ?x ?y ? ? ?compass ?)
  =>
  (bind ?far (distance ?x ?y ?mate-x ?mate-y))
  (bind ?aside (aside ?x ?y ?compass ?mate-x ?mate-y))
  (bind ?speed (follow-speed ?far (mate-moves ?mate-x ?mate-y)))
  (if (= ?speed 0) then
    (standing ?time ?x ?y))
  (steer ?speed (- (detour ?time ?x ?y ?compass ?aside) (pass-by ?far)) (- ?far 450))
  (update-sensors)
  (tell-position ?x ?y))

; The mate has not said anything yet, or not for a long time.
(defrule wait-for-mate
  (declare (salience -10))
  (goal follow)
  (position ? ?x ?y $?)
  =>
  (stop)
  (update-sensors)
  (tell-position ?x ?y))
