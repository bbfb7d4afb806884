; SPDX-License-Identifier: Apache-2.0
;
; Offers maps in the yellow pages, says where it is, and sells in a layer of its own.
(extends "market.clp")

(defglobal
  ?*price* = 10)

(defrule open-shop
  (event on-run)
  =>
  (advertise maps price ?*price* area 12.5))

(defrule say-where
  (declare (salience 10))
  ?mail <- (mail (performative ask-one) (content where))
  (position ? ?x ?y $?)
  =>
  (reply ?mail at ?x ?y)
  (retract ?mail))

; Layer 4 is trade: who asks for a price gets one.  The rest is passed on.
(deffunction trade (?id ?from ?performative ?content)
  (if (eq ?performative cfp) then (reply ?id price ?*price*) else FALSE))

(on-layer 4 trade)
