from .normal_form import NormalForm as NormalForm
