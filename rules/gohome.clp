; SPDX-License-Identifier: Apache-2.0
;
; (gohome X Y), (goto X Y): goes to a point in mm, along the way of way.clp, and as near to it as
; there is room for the robot.  Where no way leads it says so and stays.  (stay): stands still.

(defglobal
  ?*gohome-near* = 150    ; mm: there
  ?*gohome-speed* = 350)  ; mm/s

(deffunction gohome (?x ?y)
  (bind ?*way-until* -1.0)
  (bind ?*way-known* FALSE)
  (new-goal gohome ?x ?y))

(deffunction goto (?x ?y)
  (gohome ?x ?y))

(deffunction stay ()
  (stop)
  (new-goal stay))

(defrule gohome-arrived
  (declare (salience 5))
  (goal gohome ?home-x ?home-y)
  (position ? ?x ?y $?)
  (test (or (< (distance ?x ?y ?home-x ?home-y) ?*gohome-near*)
            (way-done ?x ?y ?*gohome-near*)))
  =>
  (stay)
  (update-sensors)
  (tell-position ?x ?y))

(defrule gohome
  (goal gohome ?home-x ?home-y)
  (position ?time ?x ?y ? ? ?compass ?)
  =>
  (if (or (< ?time ?*way-until*) (plan-way ?time ?home-x ?home-y))
   then (go-on ?time ?x ?y ?compass ?*gohome-speed*)
   else (printout t "there is no way to " ?home-x " " ?home-y crlf)
        (stay))
  (update-sensors)
  (tell-position ?x ?y))

(defrule stay
  (goal stay)
  (position ? ?x ?y $?)
  =>
  (stop)
  (update-sensors)
  (tell-position ?x ?y))
