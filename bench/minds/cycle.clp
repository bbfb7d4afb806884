; SPDX-License-Identifier: Apache-2.0
;
; One controller cycle: five percept facts, two rules and four calls of the robot's functions.  Goes
; to the middle between a fiducial and a blob of colour, the slower the less room there is.

(defglobal
  ?*room* = 500) ; mm, as (sonar-data) has it

(defrule look-ahead
  (declare (salience 10))
  (position ? ? ? ? ?turn-rate $?)
  (sonar ? ? ?s1 ?s2 ?s3 ?s4 ?s5 ?s6 $?)
  (test (< (abs ?turn-rate) 180))
  =>
  (bind ?*room* (sonar-data ?s1 ?s2 ?s3 ?s4 ?s5 ?s6)))

(defrule go-between
  (position ? ?x ?y ? ? ?compass ?)
  (blob ? red ?blob ? ?blob-range)
  (fiducial ? 1 ?left ?left-range ?)
  (fiducial ? 2 ?right ?right-range ?)
  (test (> ?left ?right))
  =>
  (bind ?way (speed-to ?x ?y ?compass (+ ?x ?left-range ?blob) (+ ?y (- ?right-range ?blob-range))))
  (setSpeed (min (nth$ 1 ?way) ?*room*) (nth$ 2 ?way))
  (update-sensors))
