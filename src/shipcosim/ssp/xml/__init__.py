"""XML of SSP, FMI and OSP files: documents, schemas, values, archives."""
