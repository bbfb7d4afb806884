; SPDX-License-Identifier: Apache-2.0
;
; (gohome X Y), (goto X Y): goes to a point in mm, along the way of way.clp.  (stay): stands still.

(defglobal
  ?*gohome-near* = 150    ; mm: there
  ?*gohome-speed* = 350)  ; mm/s

(deffunction gohome (?x ?y)
  (bind ?*way-until* -1.0)
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
  (test (< (distance ?x ?y ?home-x ?home-y) ?*gohome-near*))
  =>
  (stay)
  (update-sensors)
  (tell-position ?x ?y))

(defrule gohome
  (goal gohome ?home-x ?home-y)
  (position ?time ?x ?y ? ? ?compass ?)
  =>
  (if (>= ?time ?*way-until*) then
    (plan-way ?time ?home-x ?home-y))
  (go-on ?time ?x ?y ?compass ?*gohome-speed*)
  (update-sensors)
  (tell-position ?x ?y))

(defrule stay
  (goal stay)
  (position ? ?x ?y $?)
  =>
  (stop)
  (update-sensors)
  (tell-position ?x ?y))
