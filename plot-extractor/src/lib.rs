//! CFAR detection, clustering and centroiding: cells in, plots with decision statistics out.
