; SPDX-License-Identifier: Apache-2.0
;
; A robot that bids for places: one is worth more to it the nearer it is.  It drives to what it has
; bought, says so, and bids for nothing else meanwhile.  auctioneer.clp is the other side.

(defglobal
  ?*worth* = 20000        ; of a place here, in mm of way
  ?*there* = 300)         ; mm: the place is visited

(deffacts beginning
  (goal stay))

(defrule enter
  (event on-run)
  =>
  (group-join bidders))

(defrule refuse
  (declare (salience 11))
  ?mail <- (mail (performative cfp) (from ?house) (conversation ?lot))
  (bought $?)
  =>
  (retract ?mail)
  (speak refuse ?house (create$ busy) conversation ?lot))

(defrule bid
  (declare (salience 10))
  ?mail <- (mail (performative cfp) (from ?house) (conversation ?lot) (content lot ?n ?x ?y))
  (position ? ?my-x ?my-y $?)
  (not (bought $?))
  =>
  (retract ?mail)
  (bind ?worth (max 0 (- ?*worth* (distance ?my-x ?my-y ?x ?y))))
  (speak propose ?house (create$ bid ?n ?worth) conversation ?lot))

; More urgent than to answer the next call, which may come with it.
(defrule win
  (declare (salience 12))
  ?mail <- (mail (performative accept-proposal) (from ?house) (content sold ?n ?x ?y ?))
  =>
  (retract ?mail)
  (assert (bought ?house ?n ?x ?y))
  (goto ?x ?y))

(defrule lose
  (declare (salience 10))
  ?mail <- (mail (performative reject-proposal))
  =>
  (retract ?mail))

(defrule visit
  (declare (salience 9))
  ?bought <- (bought ?house ?n ?x ?y)
  (position ? ?my-x ?my-y $?)
  (test (< (distance ?my-x ?my-y ?x ?y) ?*there*))
  =>
  (retract ?bought)
  (speak inform ?house (create$ visited ?n) conversation (sym-cat lot- ?n))
  (stay))
