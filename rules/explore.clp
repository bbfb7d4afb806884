; SPDX-License-Identifier: Apache-2.0
;
; (explore [RADIUS]): goes to places where it has not been, as far as RADIUS mm from where it begins.
; With a map it chooses among places that can be reached; without one it heads for them all the same,
; and gives up one that takes too long.

(defglobal
  ?*explore-radius* = 12000
  ?*explore-x* = 0          ; the middle
  ?*explore-y* = 0
  ?*explore-tries* = 12     ; places to choose from
  ?*explore-grid* = 1500    ; mm: one visit counts for so much
  ?*explore-near* = 500     ; mm: there
  ?*explore-speed* = 350    ; mm/s
  ?*explore-time* = 60)     ; s for one place

(deffunction explore ($?radius)
  (if (> (length$ ?radius) 0) then
    (bind ?*explore-radius* (nth$ 1 ?radius)))
  (bind ?here (position))
  (if (> (length$ ?here) 0) then
    (bind ?*explore-x* (nth$ 2 ?here))
    (bind ?*explore-y* (nth$ 3 ?here)))
  (new-goal explore))

(deffunction explore-cell (?mm)
  (round (/ ?mm ?*explore-grid*)))

(deffunction explore-new (?x ?y)
  "How far a place is from all that was visited, in mm; at most 10 m."
  (bind ?least 10000)
  (progn$ (?fact (findall (visited ? ?)))
    (bind ?cell (fact-fields ?fact))
    (bind ?least (min ?least (distance ?x ?y (* ?*explore-grid* (nth$ 1 ?cell))
                                             (* ?*explore-grid* (nth$ 2 ?cell))))))
  ?least)

(deffunction explore-choose (?time)
  "Of some random places the one that is farthest from what is known, and can be reached."
  (bind ?best -1)
  (bind ?best-x ?*explore-x*)
  (bind ?best-y ?*explore-y*)
  (bind ?reach (round ?*explore-radius*))
  (loop-for-count ?*explore-tries*
    (bind ?x (+ ?*explore-x* (random (- 0 ?reach) ?reach)))
    (bind ?y (+ ?*explore-y* (random (- 0 ?reach) ?reach)))
    (bind ?new (explore-new ?x ?y))
    (if (> ?new ?best) then
      (if (or (plan ?x ?y) (not (has-map))) then
        (bind ?best ?new)
        (bind ?best-x ?x)
        (bind ?best-y ?y))))
  (bind ?*way-until* -1.0)
  (assert (exploring ?best-x ?best-y (+ ?time ?*explore-time*))))

(defrule explore-begin
  (declare (salience 6))
  (goal explore)
  (not (exploring $?))
  (position ?time ?x ?y ? ? ?compass ?)
  =>
  (explore-choose ?time))

; Where it has been, whatever it wanted there.
(defrule explore-note
  (declare (salience 7))
  (goal explore)
  (position ?time ?x ?y ? ? ?compass ?)
  (not (visited =(explore-cell ?x) =(explore-cell ?y)))
  =>
  (assert (visited (explore-cell ?x) (explore-cell ?y))))

(defrule explore-arrived
  (declare (salience 5))
  (goal explore)
  ?place <- (exploring ?to-x ?to-y ?until)
  (position ?time ?x ?y ? ? ?compass ?)
  (test (or (< (distance ?x ?y ?to-x ?to-y) ?*explore-near*) (> ?time ?until)))
  =>
  (assert (visited (explore-cell ?to-x) (explore-cell ?to-y)))
  (retract ?place))

(defrule explore-end
  (declare (salience 6))
  (not (goal explore))
  ?place <- (exploring $?)
  =>
  (retract ?place))

(defrule explore
  (goal explore)
  (exploring ?to-x ?to-y ?)
  (position ?time ?x ?y ? ? ?compass ?)
  =>
  (if (>= ?time ?*way-until*) then
    (plan-way ?time ?to-x ?to-y))
  (go-on ?time ?x ?y ?compass ?*explore-speed*)
  (update-sensors)
  (tell-position ?x ?y))
