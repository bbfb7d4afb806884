; SPDX-License-Identifier: Apache-2.0
;
; The manager of a contract net without bodies: gives forty jobs to whoever is done with one first.
; Calls for proposals, accepts the best, rejects the rest, hears when a job is done.  clerk.clp is the
; other side.

(defglobal
  ?*jobs* = 40
  ?*patience* = 0.5       ; s for proposals
  ?*pause* = 0.5          ; s before a job that nobody has time for is called again
  ?*done* = 0)

(deffunction job-name (?n)
  (sym-cat job- ?n))

(defrule begin
  (event on-run)
  =>
  (after 1 call 1))

(defrule call
  (declare (salience 10))
  ?timeout <- (timeout call ?n)
  =>
  (retract ?timeout)
  (assert (called ?n))
  (speak cfp group:workers (create$ task ?n) conversation (job-name ?n) reply-with (job-name ?n))
  (after ?*patience* close ?n))

(defrule hear-proposal
  (declare (salience 20))
  ?mail <- (mail (performative propose) (from ?who) (content takes ?n ?s))
  (called ?n)
  =>
  (retract ?mail)
  (assert (proposal ?n ?who ?s)))

; The shortest time wins; of equal ones the name that comes first.
(defrule award
  (declare (salience 9))
  ?timeout <- (timeout close ?n)
  ?called <- (called ?n)
  (proposal ?n ?best ?s)
  (not (proposal ?n ? ?less&:(< ?less ?s)))
  (not (proposal ?n ?other&:(< (str-compare ?other ?best) 0) ?s))
  =>
  (retract ?timeout ?called)
  (speak accept-proposal ?best (create$ do ?n) conversation (job-name ?n))
  (progn$ (?proposal (findall (proposal ?n ? ?)))
    (bind ?who (nth$ 2 (fact-fields ?proposal)))
    (if (neq ?who ?best) then
      (speak reject-proposal ?who (create$ taken ?n) conversation (job-name ?n)))
    (retract ?proposal))
  (if (< ?n ?*jobs*) then
    (after ?*patience* call (+ ?n 1))))

(defrule call-again
  (declare (salience 8))
  ?timeout <- (timeout close ?n)
  ?called <- (called ?n)
  =>
  (retract ?timeout ?called)
  (after ?*pause* call ?n))

(defrule hear-done
  (declare (salience 20))
  ?mail <- (mail (performative inform) (content done ?n))
  =>
  (retract ?mail)
  (bind ?*done* (+ ?*done* 1))
  (if (= ?*done* ?*jobs*) then
    (printout t "all is done at " (now) " s" crlf)
    (broadcast all-done ?*done*)))
