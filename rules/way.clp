; SPDX-License-Identifier: Apache-2.0
;
; Going to a point by way of (plan) where the robot has a map, else straight on: plan-way says where
; to, or that there is no way, go-on does one step, and way-done says that its end is near.

(defglobal
  ?*way* = (create$)      ; x y of each corner that is still ahead
  ?*way-known* = FALSE    ; it comes from a map
  ?*way-until* = -1.0     ; s: then it is planned again
  ?*way-time* = 4         ; s
  ?*way-corner* = 250     ; mm: so near to a corner the next one counts
  ?*way-care* = 420)      ; mm: ?*care* on a way that is known to be free

(deffunction plan-way (?time ?x ?y)
  "FALSE: there is a map, and no way on it."
  (bind ?way (plan ?x ?y))
  (if (and (not ?way) (has-map)) then
    (return FALSE))
  (bind ?*way-known* (neq ?way FALSE))
  (bind ?*way* (if ?way then ?way else (create$ ?x ?y)))
  (bind ?*way-until* (+ ?time ?*way-time*)))

(deffunction pass-corners (?x ?y)
  "Forgets the corners that are behind."
  (while (and (> (length$ ?*way*) 2)
              (< (distance ?x ?y (nth$ 1 ?*way*) (nth$ 2 ?*way*)) ?*way-corner*)) do
    (bind ?*way* (rest$ (rest$ ?*way*)))))

(deffunction way-done (?x ?y ?near)
  "Whether the end of a known way is near: as near to a point in a wall as a robot can come."
  (and ?*way-known*
       (= (length$ ?*way*) 2)
       (< (distance ?x ?y (nth$ 1 ?*way*) (nth$ 2 ?*way*)) ?near)))

(deffunction steer-by-map (?speed ?aside ?far)
  "A direction out of a plan needs less care than one into the unknown.  Turns first, then drives."
  (bind ?care ?*care*)
  (bind ?*care* ?*way-care*)
  (if (> (abs ?aside) 50)
   then (setSpeed 0 (if (> ?aside 0) then ?*steer-turn* else (- 0 ?*steer-turn*)))
   else (steer ?speed ?aside ?far))
  (bind ?*care* ?care))

(deffunction go-on (?time ?x ?y ?compass ?speed)
  "One step along the way."
  (pass-corners ?x ?y)
  (bind ?to-x (nth$ 1 ?*way*))
  (bind ?to-y (nth$ 2 ?*way*))
  (bind ?far (distance ?x ?y ?to-x ?to-y))
  (bind ?aside (aside ?x ?y ?compass ?to-x ?to-y))
  (bind ?slow (if (> (length$ ?*way*) 2) then ?speed else (clamp ?far 80 ?speed)))
  (if ?*way-known*
   then (steer-by-map ?slow (detour ?time ?x ?y ?compass ?aside) ?far)
   else (steer ?slow (detour ?time ?x ?y ?compass ?aside) ?far)))
