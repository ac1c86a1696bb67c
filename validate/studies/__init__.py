"""Long studies: numbered tasks for many processes or machines, and records to continue a stopped run."""
