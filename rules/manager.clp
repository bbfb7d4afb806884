; SPDX-License-Identifier: Apache-2.0
;
; The manager of a contract net: calls for proposals for one job after the other, accepts the cheapest,
; rejects the rest, and hears when it is done.  contractor.clp is the other side.
;
; The speech acts are FIPA's: cfp, propose or refuse, accept-proposal or reject-proposal, inform.  All
; that is said of a job has its name as conversation.

(defglobal
  ?*jobs* = (create$ 5000 -4500  0 4800  -5500 4500  5500 5000  0 -4500) ; x y of each, in mm
  ?*bidders* = 3          ; so many are called
  ?*patience* = 1.0       ; s for proposals
  ?*pause* = 2.0          ; s before a job that nobody wanted is called again
  ?*done* = 0)

(deffacts beginning
  (goal stay)
  (todo 1)
  (todo 2)
  (todo 3)
  (todo 4)
  (todo 5))

(deffunction jobs-count ()
  (div (length$ ?*jobs*) 2))

(deffunction job-name (?n)
  (sym-cat job- ?n))

(deffunction job-x (?n)
  (nth$ (- (* 2 ?n) 1) ?*jobs*))

(deffunction job-y (?n)
  (nth$ (* 2 ?n) ?*jobs*))

; One call at a time, in order; the group is complete, so that everybody hears it.
(defrule call
  (declare (salience 10))
  ?todo <- (todo ?n)
  (not (todo ?less&:(< ?less ?n)))
  (not (called $?))
  (position ?time $?)
  (test (>= (length$ (members contractors)) ?*bidders*))
  =>
  (retract ?todo)
  (assert (called ?n ?time))
  (speak cfp group:contractors (create$ task ?n (job-x ?n) (job-y ?n))
         conversation (job-name ?n) reply-with (job-name ?n)))

(defrule hear-proposal
  (declare (salience 10))
  ?mail <- (mail (performative propose) (from ?who) (conversation ?job) (content cost ?cost))
  =>
  (retract ?mail)
  (assert (proposal ?job ?who ?cost)))

(defrule hear-refusal
  (declare (salience 10))
  ?mail <- (mail (performative refuse))
  =>
  (retract ?mail))

; Everybody had time to answer: the cheapest gets the job, and everybody an answer.
(defrule award
  (declare (salience 8))
  ?called <- (called ?n ?since)
  (position ?time $?)
  (test (> (- ?time ?since) ?*patience*))
  (proposal ?job&:(eq ?job (job-name ?n)) ?best ?cost)
  (not (proposal ?job ? ?less&:(< ?less ?cost)))
  =>
  (retract ?called)
  (speak accept-proposal ?best (create$ do ?n (job-x ?n) (job-y ?n)) conversation ?job)
  (progn$ (?proposal (findall (proposal ?job ? ?)))
    (bind ?who (nth$ 2 (fact-fields ?proposal)))
    (if (neq ?who ?best) then
      (speak reject-proposal ?who (create$ taken ?n) conversation ?job))
    (retract ?proposal)))

; All were busy: it asks again.
(defrule call-again
  (declare (salience 7))
  ?called <- (called ?n ?since)
  (position ?time $?)
  (test (> (- ?time ?since) (+ ?*patience* ?*pause*)))
  =>
  (retract ?called)
  (assert (todo ?n)))

(defrule hear-done
  (declare (salience 10))
  ?mail <- (mail (performative inform) (from ?who) (content done ?n))
  =>
  (retract ?mail)
  (bind ?*done* (+ ?*done* 1))
  (printout t "job " ?n " is done by " ?who crlf)
  (if (= ?*done* (jobs-count)) then
    (broadcast all-done ?*done*)))

; A contractor that failed: the job is called again.
(defrule hear-failure
  (declare (salience 10))
  ?mail <- (mail (performative failure) (content gave-up ?n))
  =>
  (retract ?mail)
  (assert (todo ?n)))
