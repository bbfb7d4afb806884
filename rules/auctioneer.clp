; SPDX-License-Identifier: Apache-2.0
;
; An auctioneer without a body: sells places, one after the other, to the robot that bids most for it.
; The winner pays the second price, so that a robot does best to bid what a place is worth to it.
; bidder.clp is the other side.
;
; The speech acts are FIPA's: cfp, propose or refuse, accept-proposal or reject-proposal, inform.  All
; that is said of a lot has its name as conversation.

(defglobal
  ?*lots* = (create$ 5000 -4500  0 4800  -5500 4500  5500 5000  0 -4500) ; x y of each, in mm
  ?*patience* = 1.0       ; s for bids
  ?*pause* = 2.0          ; s before a lot that nobody wanted is called again
  ?*income* = 0
  ?*visited* = 0)

(deffunction lots-count ()
  (div (length$ ?*lots*) 2))

(deffunction lot-name (?n)
  (sym-cat lot- ?n))

(deffunction lot-place (?n)
  (subseq$ ?*lots* (- (* 2 ?n) 1) (* 2 ?n)))

; All bidders are in their group by then.
(defrule open-the-house
  (event on-run)
  =>
  (after 1 call 1))

(defrule call
  (declare (salience 10))
  ?timeout <- (timeout call ?n)
  =>
  (retract ?timeout)
  (assert (called ?n))
  (speak cfp group:bidders (create$ lot ?n (lot-place ?n))
         conversation (lot-name ?n) reply-with (lot-name ?n))
  (after ?*patience* close ?n))

(defrule hear-bid
  (declare (salience 20))
  ?mail <- (mail (performative propose) (from ?who) (content bid ?n ?worth))
  (called ?n)
  =>
  (retract ?mail)
  (assert (bid ?n ?who ?worth)))

(defrule hear-refusal
  (declare (salience 20))
  ?mail <- (mail (performative refuse))
  =>
  (retract ?mail))

(deffunction second-price (?n ?best)
  "What the others would have paid at most; 0: nobody else has bid."
  (bind ?price 0)
  (progn$ (?bid (findall (bid ?n ? ?)))
    (bind ?fields (fact-fields ?bid))
    (if (neq (nth$ 2 ?fields) ?best) then
      (bind ?price (max ?price (nth$ 3 ?fields)))))
  ?price)

(defrule award
  (declare (salience 9))
  ?timeout <- (timeout close ?n)
  ?called <- (called ?n)
  (bid ?n ?best ?worth)
  (not (bid ?n ? ?more&:(> ?more ?worth)))
  =>
  (retract ?timeout ?called)
  (bind ?price (second-price ?n ?best))
  (bind ?*income* (+ ?*income* ?price))
  (printout t (lot-name ?n) " goes to " ?best " for " (round ?price) crlf)
  (speak accept-proposal ?best (create$ sold ?n (lot-place ?n) ?price) conversation (lot-name ?n))
  (progn$ (?bid (findall (bid ?n ? ?)))
    (bind ?who (nth$ 2 (fact-fields ?bid)))
    (if (neq ?who ?best) then
      (speak reject-proposal ?who (create$ lost ?n) conversation (lot-name ?n)))
    (retract ?bid))
  (if (< ?n (lots-count)) then
    (after ?*patience* call (+ ?n 1))))

(defrule call-again
  (declare (salience 8))
  ?timeout <- (timeout close ?n)
  ?called <- (called ?n)
  =>
  (retract ?timeout ?called)
  (after ?*pause* call ?n))

(defrule hear-visit
  (declare (salience 20))
  ?mail <- (mail (performative inform) (from ?who) (content visited ?n))
  =>
  (retract ?mail)
  (bind ?*visited* (+ ?*visited* 1))
  (printout t (lot-name ?n) " is visited by " ?who crlf)
  (if (= ?*visited* (lots-count)) then
    (broadcast sold-out ?*income*)))
