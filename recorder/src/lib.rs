//! Records every service with losses accounted for; latency histograms, scores and the report.
