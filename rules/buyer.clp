; SPDX-License-Identifier: Apache-2.0
;
; Looks for somebody who sells maps, asks where that is and what one costs, tells the group, and
; goes there.
(extends "market.clp")

; More urgent than to stand still or to drive, which ends the step; so are the others.
(defrule look-for-maps
  (declare (salience 10))
  (position $?)
  (not (asked $?))
  (test (market-is-open 3))
  =>
  (bind ?shops (find-service maps price<=20))
  (if (> (length$ ?shops) 0) then
    (bind ?shop (nth$ 1 ?shops))
    (assert (asked ?shop (ask-one ?shop where) (send-layer 4 cfp ?shop one map)))))

(defrule hear-where
  (declare (salience 10))
  (asked ?shop ?where ?)
  ?mail <- (mail (in-reply-to ?where) (content at ?x ?y))
  =>
  (retract ?mail)
  (goto (+ ?x 1000) ?y))

(defrule hear-price
  (declare (salience 10))
  (asked ?shop ? ?price)
  ?mail <- (mail (layer 4) (in-reply-to ?price) (content price ?costs))
  =>
  (retract ?mail)
  (printout t "bought from " ?shop " for " ?costs crlf)
  (group-send market bought ?*my-name* ?costs))

; A mail that nobody understands is answered so: (send-layer 5 cfp red) on a console shows it.
(defrule hear-refusal
  (declare (salience 10))
  ?mail <- (mail (performative not-understood) (from ?who) (layer ?layer))
  =>
  (retract ?mail)
  (printout t ?who " has no layer " ?layer crlf))
