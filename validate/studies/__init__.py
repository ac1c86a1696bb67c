"""Long studies: numbered tasks for many processes or machines, and rows that a stopped run goes on from."""
