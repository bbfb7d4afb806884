; SPDX-License-Identifier: Apache-2.0
;
; A contractor without a body: says how long it would take, works so long, and is silent to other calls
; meanwhile.  dispatcher.clp is the other side.

(defrule enter
  (event on-run)
  =>
  (group-join workers))

(defrule propose
  (declare (salience 10))
  ?mail <- (mail (performative cfp) (from ?boss) (conversation ?job) (content task ?n))
  (not (working $?))
  =>
  (retract ?mail)
  (speak propose ?boss (create$ takes ?n (/ (random 50 150) 10)) conversation ?job))

(defrule ignore
  (declare (salience 11))
  ?mail <- (mail (performative cfp))
  (working $?)
  =>
  (retract ?mail))

(deffunction finish (?boss ?n)
  (progn$ (?work (findall (working ?n)))
    (retract ?work))
  (speak inform ?boss (create$ done ?n) conversation (sym-cat job- ?n)))

(defrule work
  (declare (salience 12))
  ?mail <- (mail (performative accept-proposal) (from ?boss) (content do ?n))
  =>
  (retract ?mail)
  (assert (working ?n))
  (after (/ (random 50 150) 10) (str-cat "(finish " ?boss " " ?n ")")))

(defrule lose
  (declare (salience 10))
  ?mail <- (mail (performative reject-proposal))
  =>
  (retract ?mail))
