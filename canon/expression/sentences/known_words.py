"""Known words of many languages: those that name a formula or lead to it, those that deny it or leave it open.

A word of the first lists says nothing of a formula. One of the last does, or may: a text that holds it is not read.
"""

from __future__ import annotations

import re

__all__ = ["ALSO", "HARMLESS", "LEADING", "WHERE", "is_denial"]


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


_TOGETHER = frozenset(("si ottiene", "si ha", "si trova", "si ricava", "si scrive"))
"""Words that lead to a formula only together: *si* alone is *if*."""
HARMLESS = (
    _words(
        """
    a an and as at by from in is it its of on so the to we all are this that these which where here there then
    thus hence therefore finally now also have has get gets got find found obtain obtains obtained gives give
    yields follows follow leads reads becomes equals using use used apply applying simplifying solving solved be
    into our my one i equation equations motion system systems answer answers result results solution final
    formula expression form forms problem part case law laws principle definition hamiltonian lagrangian routhian
    kamiltonian momentum momenta energy function kinetic potential total conserved constant constants coordinate
    coordinates canonical generalized generalised lagrange hamilton newton euler hooke kepler poisson bracket
    brackets simple harmonic oscillator pendulum spring mass length gravity gravitational acceleration angular
    frequency natural velocity speed time radius angle angles well known standard usual required desired new
    transformed corresponding order differential ordinary eq eqs eqn eqns sol soln ans dynamics ode eom denotes
    denote called for every any der die das den dem des ein eine ist sind lautet lauten somit daher damit daraus
    dies dieses folgt ergibt erhält erhalten man wir sich bewegungsgleichung bewegungsgleichungen gleichung
    gleichungen lösung antwort ergebnis energie hamiltonfunktion lagrangefunktion impuls federkonstante masse
    länge wobei dann nach la le les un une du de est sont donc ainsi alors nous obtient trouve avons équation
    équations mouvement réponse résultat énergie hamiltonien lagrangien el los las es son por lo tanto entonces
    luego así obtenemos resulta queda ecuación ecuaciones movimiento respuesta solución resultado energía
    hamiltoniano lagrangiano del que se cyclotron frictional force forces tension following let us thereby
    lagrangians hamiltonians chain sum deduce deduces deduced derive derived write writes written read holds
    governing gilt gelten nun zwangskraft zwangskräfte reibungskraft fadenkraft normalkraft beschleunigung
    geschwindigkeit winkelgeschwindigkeit richtung radialer radiale tangentialer kreisfrequenz eigenfrequenz kraft
    kräfte mit für im folglich gesucht gesuchte hamiltonschen lagrangeschen gleichungssystem gesamtenergie en
    déduit déduire obtenons trouvons écrit écrire avec pour fil pulsation système totale cinétique potentielle
    finalement s'écrit s'écrivent vaut valent vérifie où d'où il vient au aux ecuacion función generatriz vale
    valen tensión fuerza deducimos sistema obtiene siguiente finalmente tiene tenemos con para quindi dunque
    perciò pertanto equazione equazioni della delle dei di moto gli tensione forza forze risposta risultato
    soluzione otteniamo ottiene abbiamo trova troviamo segue seguente energia è sono per cui hamiltoniana
    lagrangiana vincolare filo valgono equação equações movimento portanto logo então resposta solução obtemos
    obtém força função são é temos da do dos dus bewegingsvergelijking bewegingsvergelijkingen vergelijking
    vergelijkingen antwoord volgt krijgen oplossing het een zijn geldt wordt luidt kracht równanie równania ruchu
    odpowiedź zatem więc stąd otrzymujemy mamy jest są rozwiązanie wynik siła układ mają postać układu pohybová
    pohybové rovnice odpověď řešení výsledek tedy proto dostaneme dostáváme platí je jsou síla tvar
    rörelseekvationen rörelseekvationer rörelseekvation svar alltså ekvation ekvationen blir är lösning får
    bevægelsesligningen bevægelsesligning bevegelsesligningen bevegelsesligning svaret ligning ligningen derfor
    altså mozgásegyenlet megoldás válasz tehát így eredmény hareket denklemi denklemleri denklem cevap yanıt sonuç
    böylece çözüm ecuația ecuațiile mișcare mișcării răspuns răspunsul deci rezultă obținem soluție rezultat
    vastaus liikeyhtälö liikeyhtälöt siis ratkaisu ответ уравнение уравнения движения движение система имеет имеют
    вид получаем получим следовательно отсюда тогда таким образом итак значит решение результат натяжение нити
    сила силы энергия полная гамильтониан лагранжиан функция гамильтона лагранжа равна равно равен равны множитель
    из этого следует что находим имеем есть для маятника уравнений циклическая частота реакция связи ускорение
    скорость импульс запишем окончательно відповідь рівняння руху отже маємо отримуємо розв'язок звідси отговор
    уравнението движението следователно получаваме решението άρα επομένως συνεπώς εξίσωση εξισώσεις κίνησης
    απάντηση λύση είναι προκύπτει έχουμε τελικά οι της una uno kurz brief bref insgesamt schließlich short period
    reaction accelerations rates constraint normal spannung zugkraft seilkraft periode schwingungsdauer drehimpuls
    differentialgleichung endergebnis lagrangegleichung lagrangegleichungen lagrange-funktion hamilton-funktion
    kinetische gesamte pendel pendels feder accélération accélérations vitesse impulsion période fonction
    hamiltonienne lagrangienne réaction normale lien aceleración aceleraciones velocidad momento frecuencia
    periodo fuerzas ligadura movimientos péndulo accelerazione accelerazioni velocità frequenza reazione vincolo
    impulso funzione pendolo aceleração velocidade tensão frequência versnelling spankracht snelheid
    przyspieszenie napięcie naciąg prędkość zrychlení napětí период ускорения натяжения реакции связь маятник
    accelerationen zu liefert donne teil simplifiant simplification simplified simplify vi first second third
    schwingungsgleichung harmonischer harmonischen harmonische oszillator oszillators oscillateur harmonique
    oscilador armónico oscillatore armonico osciladores гармонический осциллятор рода sho shm ricava scrive
    lagrange-gleichung lagrange-gleichungen bekommt bekommen erhaltungsgröße erhaltungsgrößen conservée conservées
    grandeur grandeurs cantidad conservada grandezza conservata conservativa grootheid behouden impulsmoment konstant
    konstante constante constantes costante costanti cyclic zyklisch cyclique cíclica ciclica explicitly explizit
    """
    )
    | _TOGETHER
)
"""Words that name a formula or lead to it and never change what it says; any other word is read as a part of it."""
LEADING = (
    _words(
        """
    also are becomes equals find follows get gets gives have hence is obtain obtains reads so that then therefore
    thus yields lautet lauten ist folgt ergibt somit daher dann donc ainsi alors est trouve obtient tanto entonces
    luego es resulta obtenemos write writes gilt folglich obtenons trouvons déduit vaut valent vient vale valen
    queda son tiene tenemos sono è quindi dunque perciò pertanto otteniamo ottiene abbiamo segue portanto logo
    então obtemos obtém são é temos dus krijgen volgt luidt geldt zatem więc stąd otrzymujemy mamy jest są tedy
    proto dostaneme dostáváme platí je jsou alltså blir är får altså derfor tehát így böylece deci rezultă obținem
    siis вид получаем получим следовательно отсюда тогда образом итак значит равна равно равен равны находим имеем
    есть что отже маємо отримуємо звідси следователно получаваме άρα επομένως συνεπώς είναι προκύπτει έχουμε
    τελικά zu liefert donne finalement où obtiene que da cui erhält erhalten bekommt bekommen
    """
    )
    | _TOGETHER
)
"""Those of them that a formula may follow."""
ALSO = _words("and und et y e и та και oraz og och en ve és și şi sowie 和 及 与 與 以及 と 및 & |")
"""Words between two equations both of which are said."""
SO = _words(
    """
    also daher somit folglich mithin donc alors quindi dunque luego portanto zatem więc alltså następnie следовательно
    значит отсюда
    """
)
"""Words behind a comma or a semicolon before an equation that follows from the one before."""
WHERE = _words(
    """
    where with mit wobei avec où donde con dove siendo sendo onde com gdzie kde met waarbij waar hvor där med ahol где
    де
    όπου unde
    """
)
"""Words before what a letter abbreviates."""

_DENIED = re.compile(
    r"""
    n.*|un.*|н[еи].*|нет|без.*|ні.*|bez.*|in(?!tegra|iti|ert|tens|stan|diz|dic|forma|teg|dem).*|im(?!puls).*|dis.*
    |mis.*|anti.*|contr.*|count.*|gegen.*|wider.*|wieder?leg.*|anders.*|statt.*|anstatt|instead|versus|vs|unlike
    |kein.*|ohne|sans|senza|sin|sem|sine|without|zonder|uden|utan|uten|fără|lipsit.*|pas|point|jamais|jama.s|aucun.*
    |rien|guère|personne|ei.*|eivät|ikke|icke|inte|inga|inget|ingen.*|ej|değil.*|yok.*|hayır|nunca|tampoco|mai
    |fa[lu][slx].*|väär.*|error.*|err(?:eur|ore|o|ado|oné|ato).*|erro.*|fel|felaktig.*|fejl.*|feil.*|fehl.*|fout.*|wrong.*
    |wron.*|verkeerd.*|onjuist.*|onwaar.*|hibás.*|hamis.*|yanlış.*|greșit.*|gresit.*|eroare|chyb.*|błęd.*|bledn.*
    |nepr.*|špatn.*|опроверг.*|ошиб.*|ложн.*|лож.*|помилк.*|хибн.*|грешк.*|грешн.*|λάθος.*|εσφαλ.*|ψευδ.*|αδύνατ.*
    |δεν|δε|όχι|μη|μην|μήτε|ούτε|χωρίς|δίχως|ουκ|άρνησ.*|mal|malo|mauvais.*|schlecht.*|bad|sbagli.*|equivoc.*|incor.*
    |opposite|oppos.*|contrair.*|contrar.*|inverse.*|invers.*|reverse.*|umgekehrt.*|rever.*|negat.*|deny|denies|denied
    |refut.*|reject.*|disprov.*|absurd.*|contradi.*|widerspr.*|fails?|failed|fallac.*|bogus|nonsense|unsinn|quatsch
    |impossib.*|imposib.*|unmögl.*|cannot|can't|couldn.*|isn.*|aren.*|doesn.*|don|didn.*|won.*|never|neither|nor
    |hardly|barely|kaum|rarely|selten|hypoth.*|example|beispiel.*|exemple|ejemplo|esempio|przykład.*|пример.*
    |question|frage|pregunta|domanda|вопрос.*|pytanie|given|gegeben.*|donné.*|dado.*|dato|dati|дано|dane
    |or|oder|ou|o|u|ó|où\?|eller|lub|albo|bądź|nebo|anebo|ili|или|либо|або|чи|vai|või|tai|vagy|sau|ori|veya|yahut
    |atau|either|entweder|ή|είτε|soit|sea|maybe|perhaps|peut|être|doubt.*
    |zweif.*|bezweif.*|doute.*|dud[ao].*|dubbi.*|сомн.*|fake.*|geraten
    |vielleicht|eventuell.*|evtl|forse|quiz.s|tal|talvez
    |może|możliwe|возможно|может|možná|misschien|wellicht|kanske|kanskje|måske|ehkä|talán|belki|poate|ίσως|proba.*
    |wahrsch.*|vermut.*|вероятно|наверное|видимо|pravděpod.*|prawdopod.*|proba.*|guess.*|think.*|believ.*|suppos.*
    |assum.*|annahme.*|angenomm.*|glaube.*|denke.*|crois|pense|would|could|should|might|may|sollte.*|könn.*|würde.*|wäre.*
    |serai.*|devrait|pourrait|sería|debería|podría|sarebbe|dovrebbe|potrebbe|powinn.*|должн.*|бы|lack.*|manqu.*|falta.*
    |manca.*|brak.*|swap.*|flip.*|vertausch.*|sign|vorzeichen.*|signe|signo|segno|знак.*|up|bis|près|factor|faktor.*
    |facteur|fattore|other|creo|credo|penso|думаю|кажется|alternat.*|another
    |autre.*|otra.*|otro.*|altra.*|altro.*|друг.*|oder|andere.*|if|wenn|falls|si|se|если|якщо|jeśli|jeżeli|pokud
    |ako|αν|εάν|hvis|om|als|ha|dacă|eğer|jos|unless|except|außer|sauf|salvo|кроме|only|nur|seul.*|solo|sólo|tylko
    |только|almost|nearly|approx.*|näherung.*|ungefähr|annähernd|environ|presque|casi|quasi|circa|około|примерн.*
    |приблиз.*|почти|σχεδόν|σχεδ.*|small|klein.*|petit.*|pequeñ.*|piccol.*|mał.*|малы.*|мал|large|limit.*|grenz.*
    |preliminar.*|draft|entwurf|brouillon|attempt.*|versuch.*|tentativ.*|intento.*|попытк.*
    |twice|double.*|doppelt.*|half|halb.*|moitié|mitad|square.*|quadrat.*
    |minus|plus|times|mal|fois|veces|volte|раз|cross.*|struck|deleted|gestrichen.*|barré|old|alt|alte|vor.*|before
    |avant|antes|prima|ранее|прежн.*|student.*|teacher.*|lehrer.*|he|she|they|said|says|claim.*|behaupt.*|prétend.*
    """,
    re.VERBOSE | re.IGNORECASE,
)
"""Words, or how words begin, that deny what follows, leave it open, give it to somebody else or restrict it.

Words that begin as negations do are among them, though many say something else: an answer that is not read can be
written again.
"""
EASTERN = re.compile(
    "方程|運動|运动|答|解|結果|结果|張力|拉力|力|速度|所以|因此|得到|从而|したがって|従って|ゆえに|故に|よって|따라서|그러므로|エネルギー|ハミルトニアン|ラグランジアン|運動量|动量|能量|式|답|해|운동|방정식|장력|가속도|에너지"
)
"""Words of Chinese, Japanese and Korean that name a formula or lead to it, at least one of which stands before it."""
_SIGNS_OF_DENIAL = re.compile(
    "[不没沒非无無未否错錯誤误假或若如果但勿莫反非異异别別除嘘違禁絶才只仅僅約约近疑問问旧例]|ない|ぬ|ません|なし|なく|なかっ|ず|まい|では|じゃ"
    "|また|もし|あるい|かも|だろう|でしょ|おそらく|たぶん|多分|恐らく|きっと|はず|らし|そう|と思|うそ|ウソ|ダメ|だめ|たら|れば|なら|か[、。?？]|か$"
    "|아니|아닌|않|못|없|또는|혹은|이나|거나|거짓|틀|오류|아마|만약|만일|면|반대|까"
)
"""The same in Chinese, Japanese and Korean, where words are not set apart."""


def is_denial(word: str) -> bool:
    """Tell whether a word denies a formula, leaves it open or restricts it, or may.

    Examples
    --------
    >>> [is_denial(word) for word in ("nicht", "Неверно", "Faux", "eller", "Beschleunigung", "Ускорение")]
    [True, True, True, True, False, False]
    >>> is_denial("運動方程式"), is_denial("正しくない")
    (False, True)
    """
    return _DENIED.fullmatch(word) is not None or _SIGNS_OF_DENIAL.search(word) is not None
