"""What a run answers: responses, histories and fields, under the names of impactlab.variables."""
